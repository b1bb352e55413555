// SPDX-License-Identifier: MIT
/// Axis-aligned boxes in double precision.
#pragma once

#include <algorithm>
#include <limits>

#include "pointsweep/math/vec3.h"

namespace pointsweep {

struct Box {
  static constexpr double kInf = std::numeric_limits<double>::infinity();
  Vec3 lo{kInf, kInf, kInf};
  Vec3 hi{-kInf, -kInf, -kInf};

  bool empty() const { return !(lo.x <= hi.x); }
  Vec3 extent() const { return empty() ? Vec3{} : hi - lo; }
  Vec3 center() const { return {0.5 * lo.x + 0.5 * hi.x, 0.5 * lo.y + 0.5 * hi.y, 0.5 * lo.z + 0.5 * hi.z}; }
  double diagonal() const { return length(extent()); }
  void include(Vec3 p) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  }
  void include(const Box& b) {
    lo = {std::min(lo.x, b.lo.x), std::min(lo.y, b.lo.y), std::min(lo.z, b.lo.z)};
    hi = {std::max(hi.x, b.hi.x), std::max(hi.y, b.hi.y), std::max(hi.z, b.hi.z)};
  }
  int longest_axis() const {
    const Vec3 e = extent();
    return e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
  }
  friend bool operator==(const Box&, const Box&) = default;
};

/// Squared distance from a point to the box, 0 inside. Rounding never makes it exceed the distance2() to a point of
/// the box: every operation is monotonic and in the same order.
inline double distance2(const Box& b, Vec3 p) {
  const double dx = std::max({b.lo.x - p.x, 0.0, p.x - b.hi.x});
  const double dy = std::max({b.lo.y - p.y, 0.0, p.y - b.hi.y});
  const double dz = std::max({b.lo.z - p.z, 0.0, p.z - b.hi.z});
  return (dx * dx + dy * dy) + dz * dz;
}

/// Squared distance between two boxes, 0 where they touch or overlap; a lower bound of distance2() of their points.
inline double distance2(const Box& a, const Box& b) {
  const double dx = std::max({a.lo.x - b.hi.x, 0.0, b.lo.x - a.hi.x});
  const double dy = std::max({a.lo.y - b.hi.y, 0.0, b.lo.y - a.hi.y});
  const double dz = std::max({a.lo.z - b.hi.z, 0.0, b.lo.z - a.hi.z});
  return (dx * dx + dy * dy) + dz * dz;
}

}  // namespace pointsweep
