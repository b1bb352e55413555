// SPDX-License-Identifier: MIT
/// Statistical outliers: points that are farther from their neighbours than most points are from theirs (R. B. Rusu,
/// "Semantic 3D object maps for everyday manipulation in human living environments", 2009), by the definitions of five
/// programs.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators.h"

namespace pointsweep {

/// The details in which the definitions of the five programs differ.
struct OutlierRule {
  bool counts_point = false;          ///< true if the mean includes the point itself, at distance 0
  bool population = false;            ///< true if the deviation is divided by n, not n - 1
  bool zero_is_outlier = false;       ///< true if points with mean distance 0 are outliers, left out of the deviation
  bool threshold_is_outlier = false;  ///< true if a distance equal to the threshold is an outlier
};
OutlierRule rule_of(OutlierDefinition definition);

template <class T>
class OptionTable;

/// Returns the options of sor and denoise.
const OptionTable<SorOptions>& sor_options();

/// Returns mean_distance, N f64, in length units: the mean distance to the neighbours; NaN without neighbours, or if
/// one has no finite place.
Attribute mean_distance_attribute();
/// Returns outlier, N u8: 1 for outliers, else 0.
Attribute outlier_attribute();

/// Makes mean_distance: Σ_j |p_j - p_i| / |N_i|, or, if the rule counts the point, / (|N_i| + 1), summed in double in
/// the order of the neighbours, at the positions the stage sees. Points without a mean distance count as degenerate.
class MeanDistance final : public LocalOperator {
 public:
  explicit MeanDistance(const SorOptions& options = {});
  std::string name() const override { return "mean_distance"; }
  Contract contract() const override { return {{}, {}, {mean_distance_attribute()}}; }
  void apply(const Neighborhoods& in, Columns& out) const override;

 private:
  bool counts_point_;
};

/// {mean, deviation, count} of the finite values of a scalar: the mean and the standard deviation, sqrt(Σ (d - mean)² /
/// (n - 1)), 0 for one value. A rule with `population` divides by n; one with `zero_is_outlier` excludes values of 0
/// from the sum of squares, but counts them in n and in the mean. The sums are exact, so that differences lose no
/// digits. The mean of no values is NaN.
class MeanAndDeviation final : public Reduction {
 public:
  explicit MeanAndDeviation(Attribute of, OutlierRule rule = {}) : of_(std::move(of)), rule_(rule) {}
  std::string text() const override;
  std::vector<Attribute> reads() const override { return {of_}; }
  std::unique_ptr<Accumulator> start() const override;

 private:
  Attribute of_;
  OutlierRule rule_;
};

/// Makes outlier: 1 for points without a mean distance, and where mean_distance > mean + multiplier * deviation over
/// all points with a mean distance, or >= if the rule has `threshold_is_outlier`; 1 also where mean_distance is 0 if
/// the rule has `zero_is_outlier`; else 0.
class Outlier final : public LocalOperator {
 public:
  explicit Outlier(const SorOptions& options, double threshold = std::numeric_limits<double>::quiet_NaN());
  std::string name() const override { return "outlier"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;
  std::shared_ptr<const LocalOperator> with_values(std::span<const std::vector<double>> values) const override;

 private:
  SorOptions options_;
  double threshold_;  ///< mean + multiplier * deviation
};

/// `sor`: MeanDistance and Outlier, in order.
class StatisticalOutliers final : public CompositeOperator {
 public:
  /// Throws UsageError for options out of their ranges.
  explicit StatisticalOutliers(const SorOptions& options = {});
  std::string name() const override { return "sor"; }
  Contract contract() const override { return {{}, {}, {mean_distance_attribute(), outlier_attribute()}}; }
  std::vector<ChainStage> parts() const override;

 private:
  SorOptions options_;
};

}  // namespace pointsweep
