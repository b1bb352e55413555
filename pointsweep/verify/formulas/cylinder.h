// SPDX-License-Identifier: MIT
/// M3C2: points of two clouds in a cylinder along a normal.
#pragma once

#include <cstddef>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// The points of one cloud in the cylinder around p along n: |a_j| <= depth and a distance from the axis of at most
/// half the diameter, with a_j = (p_j - p) . n / |n|.
class Cylinder {
 public:
  Cylinder(Vector center, const Estimate& normal, Real diameter, Real depth);

  /// Returns whether the cylinder has an axis. Without an axis, change() returns counts of 0 and NaN for all other
  /// values.
  bool has_axis() const { return norm(axis_) > 0; }
  /// Returns whether the data leave open which points are inside.
  bool is_open() const { return open_; }
  /// Returns an upper bound for the squared distance between the centre and points of the cylinder.
  Real reach2() const;
  void add(Vector point);

  std::size_t count() const { return count_; }
  Estimate mean() const;    ///< returns the mean of the a_j; NaN without points
  Estimate spread() const;  ///< returns the standard deviation of the a_j, by n - 1; NaN with fewer than two points

 private:
  Vector center_, axis_;
  Real error_, radius_, depth_;  ///< `error_` is the error of the axis
  bool open_ = false;
  std::size_t count_ = 0;
  Real first_ = 0, sum_ = 0, squares_ = 0, largest_ = 0;  ///< sums over a_j - first_, and the largest |p_j - p|
};

/// The results of M3C2 for a point: change, level of detection, and the spread and count of each cloud.
struct Change {
  Estimate distance, level, spread1, spread2, samples1, samples2;
};
/// `registration`: error of the alignment of the clouds. `either_side`: true if the sign of the normal is uncertain.
Change change(const Cylinder& before, const Cylinder& after, Real registration, bool either_side);

}  // namespace pointsweep::formulas
