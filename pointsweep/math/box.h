// SPDX-License-Identifier: MIT
/// Distances from boxes, which are lower bounds even after rounding, and the box of a cloud without its outliers.
#pragma once

#include <algorithm>
#include <span>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// Returns the squared distance from a point to the box, 0 inside. Rounding never makes the result exceed the
/// distance2() from p to a point of the box: both functions perform the same operations in the same order, and each
/// operation is monotonic.
inline double distance2(const Box& b, Vec3 p) {
  const double dx = std::max({b.lo.x - p.x, 0.0, p.x - b.hi.x});
  const double dy = std::max({b.lo.y - p.y, 0.0, p.y - b.hi.y});
  const double dz = std::max({b.lo.z - p.z, 0.0, p.z - b.hi.z});
  return (dx * dx + dy * dy) + dz * dz;
}

/// Returns the squared distance between two boxes, 0 if they touch or overlap; a lower bound of distance2() of their
/// points.
inline double distance2(const Box& a, const Box& b) {
  const double dx = std::max({a.lo.x - b.hi.x, 0.0, b.lo.x - a.hi.x});
  const double dy = std::max({a.lo.y - b.hi.y, 0.0, b.lo.y - a.hi.y});
  const double dz = std::max({a.lo.z - b.hi.z, 0.0, b.lo.z - a.hi.z});
  return (dx * dx + dy * dy) + dz * dz;
}

/// Returns the box of the middle 98 % of each coordinate of a sample. The sample must not be empty.
Box middle_box(std::span<const Vec3> sample);

}  // namespace pointsweep
