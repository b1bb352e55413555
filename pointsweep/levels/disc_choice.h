// SPDX-License-Identifier: MIT
/// The greedy choice of points no two of which are nearer than a spacing, among the points of one node.
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

/// Takes the points by rank_of(), then by coordinates, then by number, and keeps each that no point of `kept` covers,
/// to which it is added. Returns the kept points, in the order in which they were taken; none if there would be more
/// than `most`.
///
/// The choice among the points of the least ranks is the beginning of the choice among all. So the points are gone
/// through several times, each time with a higher limit for the rank, and most of them are covered from the second time
/// on, many at once (UncoveredPlaces).
std::optional<std::vector<KeptPoint>> choose_discs(const CurvePoints& points, NodeRows rows, KeptGrid& kept,
                                                   std::size_t most);

}  // namespace pointsweep
