// SPDX-License-Identifier: MIT
/// Statistical outliers: points that are farther from their neighbours than most points are from theirs (R. B. Rusu,
/// "Semantic 3D object maps for everyday manipulation in human living environments", 2009; as in PCL. PDAL, Open3D and
/// CloudCompare have filters of this kind that differ in detail).
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/operator.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration sor_declaration();

/// N f64, in length units: the mean distance to the neighbours; NaN where there are none or one has no finite place.
Attribute mean_distance_attribute();
/// N u8: 1 for outliers, else 0.
Attribute outlier_attribute();

/// Makes mean_distance: (1/|N_i|) Σ_j |p_j - p_i|, the point itself excluded, summed in double in the order of the
/// neighbours, at the positions the stage sees. Points without neighbours count as degenerate.
class MeanDistance final : public Operator {
 public:
  std::string name() const override { return "mean_distance"; }
  Contract contract() const override { return {{}, {}, {mean_distance_attribute()}}; }
  void apply(const Neighborhoods& in, Columns& out) const override;
};

/// {mean, deviation, count} of the finite values of a scalar: the mean and the standard deviation of the sample,
/// sqrt(Σ (d - mean)² / (n - 1)), 0 for one value. The sums behind both are exact; no difference of rounded sums is
/// taken. The mean of no values is NaN.
class MeanAndDeviation final : public Reduction {
 public:
  explicit MeanAndDeviation(Attribute of) : of_(std::move(of)) {}
  std::string text() const override { return "mean and deviation of " + of_.name; }
  std::vector<Attribute> reads() const override { return {of_}; }
  std::unique_ptr<Accumulator> start() const override;

 private:
  Attribute of_;
};

/// Makes outlier: 1 where mean_distance > mean + multiplier * deviation over all points that have one, and for points
/// without one; else 0.
class Outlier final : public Operator {
 public:
  explicit Outlier(double multiplier, double threshold = std::numeric_limits<double>::quiet_NaN())
      : multiplier_(multiplier), threshold_(threshold) {}
  std::string name() const override { return "outlier"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;
  std::shared_ptr<const Operator> with_values(std::span<const std::vector<double>> values) const override;
  double multiplier() const { return multiplier_; }

 protected:
  Options own_options() const override { return {{"multiplier", multiplier_}}; }

 private:
  double multiplier_;
  double threshold_;  ///< mean + multiplier * deviation
};

/// `sor`: MeanDistance and Outlier, one after the other.
class StatisticalOutliers final : public Operator {
 public:
  /// Throws UsageError unless multiplier is a number of at least 0.
  explicit StatisticalOutliers(double multiplier = 2);
  std::string name() const override { return "sor"; }
  Contract contract() const override { return {{}, {}, {mean_distance_attribute(), outlier_attribute()}}; }
  void apply(const Neighborhoods&, Columns&) const override {}
  std::vector<std::shared_ptr<const Operator>> parts() const override;

 protected:
  Options own_options() const override { return {{"multiplier", multiplier_}}; }

 private:
  double multiplier_;
};

}  // namespace pointsweep
