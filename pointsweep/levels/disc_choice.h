// SPDX-License-Identifier: MIT
/// The greedy choice of points of one node of the octree, any two of which are at least a spacing apart.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pointsweep/levels/curve_points.h"
#include "pointsweep/levels/kept_grid.h"

namespace pointsweep {

/// The points [first, first + count) of a node.
struct NodeRows {
  std::uint64_t first, count;
};

struct KeptPoint {
  std::uint64_t row;
  GridPoint point;
};

/// Takes the points by rank_of(), then by coordinates, then by number. Adds each point that no point of `kept` covers
/// (KeptGrid::covers()) to `kept`. Returns the added points in that order; nothing if they would be more than `most`.
///
/// The choice among the points of the lowest ranks is the beginning of the choice among all points. So the points are
/// read several times, each time with a higher limit for the rank. From the second time on most points are covered, and
/// one comparison with a kept point skips many of them.
std::optional<std::vector<KeptPoint>> choose_discs(const CurvePoints& points, NodeRows rows, KeptGrid& kept,
                                                   std::size_t most);

}  // namespace pointsweep
