// SPDX-License-Identifier: MIT
/// Statistical outliers: points that are farther from their neighbours than most points are from theirs (R. B. Rusu,
/// "Semantic 3D object maps for everyday manipulation in human living environments", 2009), by the definitions of five
/// programs.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pointsweep/operator.h"

namespace pointsweep {

/// The details in which the definitions of the five programs differ.
struct OutlierRule {
  bool counts_point = false;          ///< true if the mean includes the point itself, at distance 0
  bool population = false;            ///< true if the deviation is divided by n, not n - 1
  bool zero_is_outlier = false;       ///< true if points with mean distance 0 are outliers, left out of the deviation
  bool threshold_is_outlier = false;  ///< true if a distance equal to the threshold is an outlier
};

/// Returns mean_distance, N f64, in length units: the mean distance to the neighbours; NaN without neighbours, or if
/// one has no finite place.
Attribute mean_distance_attribute();
/// Returns outlier, N u8: 1 for outliers, else 0.
Attribute outlier_attribute();

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

}  // namespace pointsweep
