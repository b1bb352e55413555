// SPDX-License-Identifier: MIT
/// Edges between points, and the one order in which all parts of a forest compare them.
#pragma once

#include <cstdint>
#include <tuple>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// A point by what orders it, on any axis: x, then y, then z, then its row. The row names it.
struct PointKey {
  Vec3 position;
  std::uint64_t row = 0;
};

inline bool operator<(const PointKey& a, const PointKey& b) {
  return std::tie(a.position.x, a.position.y, a.position.z, a.row) <
         std::tie(b.position.x, b.position.y, b.position.z, b.row);
}

/// The order of points along an axis; of equal coordinates, as keys compare.
struct AlongAxis {
  int axis;
  bool operator()(const PointKey& a, const PointKey& b) const {
    if (a.position[axis] != b.position[axis]) return a.position[axis] < b.position[axis];
    return a < b;
  }
};

/// Weight and parity are functions of the two points: an edge that comes twice is one edge.
struct ForestEdge {
  double weight = 0;   ///< not NaN
  PointKey a, b;       ///< a < b
  bool flips = false;  ///< the signs of a and b differ
};

/// Total: by weight, then by the points.
inline bool operator<(const ForestEdge& a, const ForestEdge& b) {
  if (a.weight != b.weight) return a.weight < b.weight;
  if (a.a < b.a || b.a < a.a) return a.a < b.a;
  return a.b < b.b;
}

}  // namespace pointsweep
