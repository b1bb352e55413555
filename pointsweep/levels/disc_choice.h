// SPDX-License-Identifier: MIT
/// The greedy choice of points of one node of the octree, any two of which are at least a spacing apart, and the grid
/// of the points that exclude others.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/levels/curve_points.h"

namespace pointsweep {

/// The points [first, first + count) of a node.
struct NodeRows {
  std::uint64_t first, count;
};

struct KeptPoint {
  std::uint64_t row;
  GridPoint point;
};

/// Kept points in cells slightly wider than the spacing, so that all points nearer than the spacing to a place lie in
/// the cell of the place or in the 26 cells around it.
class KeptGrid {
 public:
  KeptGrid(double spacing, Vec3 corner);

  void add(Vec3 point);
  /// Returns whether a kept point is nearer to the place than the spacing.
  bool covers(Vec3 place) const;
  /// Replaces `near` by all points that may cover a place in the box. A point may be listed more than once.
  void find_near(const Box& box, std::vector<Vec3>& near) const;
  double spacing2() const { return spacing2_; }

 private:
  using Cell = std::array<std::int64_t, 3>;
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  Cell cell_of(Vec3 place) const;
  std::size_t bucket_of(const Cell& cell) const;
  void grow();
  template <class Use>
  bool any_of_cell(const Cell& cell, const Use& use) const;

  double spacing2_, cells_per_step_;
  Vec3 corner_;
  std::vector<Vec3> points_;
  std::vector<std::uint32_t> next_;   ///< the next point in the bucket of a point
  std::vector<std::uint32_t> first_;  ///< the first point of each bucket; the number of buckets is a power of two
};

/// Takes the points in ascending order of rank_of(), then of the coordinates, then of their numbers. Adds each point
/// that no point of `kept` covers (KeptGrid::covers()) to `kept`. Returns the added points in that order. Returns
/// nullopt if they would be more than `most`; then `kept` has the first `most` of them.
///
/// The choice among the points of the lowest ranks is the beginning of the choice among all points. So the points of
/// a large node are read several times, each time with a higher limit for the rank. From the second time on most points
/// are covered, and one comparison with a kept point skips many of them.
std::optional<std::vector<KeptPoint>> choose_discs(const CurvePoints& points, NodeRows rows, KeptGrid& kept,
                                                   std::size_t most);

}  // namespace pointsweep
