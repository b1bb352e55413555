// SPDX-License-Identifier: MIT
/// Edges between points, the order in which a spanning forest compares edges, and the sets that edges join.
#pragma once

#include <cstdint>
#include <tuple>
#include <vector>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// The key of a point: keys compare by x, then y, then z, then row. The row alone identifies the point.
struct PointKey {
  Vec3 position;
  std::uint64_t row = 0;
};

inline bool operator<(const PointKey& a, const PointKey& b) {
  return std::tie(a.position.x, a.position.y, a.position.z, a.row) <
         std::tie(b.position.x, b.position.y, b.position.z, b.row);
}

/// Compares points by their coordinate on an axis, and points of equal coordinate by their keys.
struct AlongAxis {
  int axis;
  bool operator()(const PointKey& a, const PointKey& b) const {
    if (a.position[axis] != b.position[axis]) return a.position[axis] < b.position[axis];
    return a < b;
  }
};

/// An edge of a forest. Each point of a forest has a sign, + or -, which states, for example, whether `orient` negates
/// its normal. `weight` and `flips` depend on the two points alone, so that an edge that is added twice counts once.
struct ForestEdge {
  double weight = 0;   ///< weight of the edge, which is not NaN
  PointKey a, b;       ///< ends of the edge, with a < b; without weights rows alone, in any order
  bool flips = false;  ///< true if a and b should have different signs
};

/// Compares edges by weight, then by their points: a total order.
inline bool operator<(const ForestEdge& a, const ForestEdge& b) {
  if (a.weight != b.weight) return a.weight < b.weight;
  if (a.a < b.a || b.a < a.a) return a.a < b.a;
  return a.b < b.b;
}

/// Returns the representative of the set of i (union-find). `parents` has the parent of each element; a representative
/// is its own parent. Shortens the paths that it follows.
inline std::uint32_t set_of(std::vector<std::uint32_t>& parents, std::uint32_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace pointsweep
