// SPDX-License-Identifier: MIT
/// The distance of points from a plane.
#pragma once

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// Takes some points twice: first for their centroid, then for their covariance around it.
class Flatness {
 public:
  void measure(Vector p);
  void add(Vector p);

  /// The root mean square distance to the plane for which it is least, as float32; 0 for fewer than four points. The
  /// operator takes positions to 2^-40, and knows eigenvalues to some roundings of the largest.
  Estimate residual() const;

 private:
  Real points_ = 0;
  Vector first_, sum_;  ///< sums are of offsets from the first point
  Matrix covariance_;   ///< times the points
};

}  // namespace pointsweep::formulas
