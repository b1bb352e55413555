// SPDX-License-Identifier: MIT
/// The formula of M3C2 (Lague et al. 2013), the change between two clouds from their points in a cylinder along a
/// normal.
#pragma once

#include <cstddef>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// The points p_j of one cloud in the cylinder around the point p along its normal n: |a_j| <= depth with a_j = (p_j -
/// p) · n / |n|, and the distance of p_j from the axis is at most half the diameter.
class Cylinder {
 public:
  Cylinder(Vector center, const Estimate& normal, Real diameter, Real depth);

  /// Returns whether the cylinder has an axis: false if the normal is 0 or not finite. change() then returns counts of
  /// 0, and NaN for all other values.
  bool has_axis() const { return norm(axis_) > 0; }
  /// Returns whether the normal is in doubt, or whether for some point errors decide whether the cylinder holds it.
  bool is_open() const { return open_; }
  /// Returns an upper bound for the squared distance between the centre and points of the cylinder.
  Real reach2() const;
  void add(Vector point);

  std::size_t count() const { return count_; }
  Estimate mean() const;    ///< returns the mean of the a_j; NaN without points
  Estimate spread() const;  ///< returns the standard deviation of the a_j, with divisor n - 1; NaN below two points

 private:
  Vector center_, axis_;
  Real error_, radius_, depth_;  ///< `error_` is the error of the axis
  bool open_ = false;
  std::size_t count_ = 0;
  /// The first a_j, the sums of a_j - first_ and of its square, and the largest |p_j - p|.
  Real first_ = 0, sum_ = 0, squares_ = 0, largest_ = 0;
};

/// The results of M3C2 for a point: change, level of detection, and the spread and count of each cloud.
struct Change {
  Estimate distance, level, spread1, spread2, samples1, samples2;
};
/// `registration`: error of the alignment of the clouds. `either_side`: true if the sign of the normal is uncertain.
Change change(const Cylinder& before, const Cylinder& after, Real registration, bool either_side);

}  // namespace pointsweep::formulas
