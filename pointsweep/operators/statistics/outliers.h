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

/// The details in which the definitions of the five programs (OutlierDefinition) differ.
struct OutlierRule {
  bool counts_point = false;          ///< true if the mean includes the point itself, at distance 0
  bool population = false;            ///< true if the deviation is divided by n, not n - 1
  bool zero_is_outlier = false;       ///< true if points with mean distance 0 are outliers, left out of the deviation
  bool threshold_is_outlier = false;  ///< true if a distance equal to the threshold is an outlier
};

/// Returns mean_distance, one float64 per point, in length units: the mean distance to the neighbours; NaN without
/// neighbours, or if the point or a neighbour has no finite place.
Attribute mean_distance_attribute();
/// Returns outlier, one uint8 per point: 1 for outliers, else 0.
Attribute outlier_attribute();

/// Computes {mean, deviation, count} of the finite values d of a scalar. The deviation is sqrt(Σ (d - mean)² / (n -
/// 1)), 0 for one value. With `population`, the divisor is n. With `zero_is_outlier`, the sum of squares excludes
/// values of 0, but n and the mean count them. The sums of d and d² are exact, so that their difference loses no
/// digits; the terms of values of 0 are subtracted in float64. Without values, the mean is NaN and the deviation 0.
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
