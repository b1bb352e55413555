// SPDX-License-Identifier: MIT
/// The kept points of a level, which exclude all points nearer to them than the spacing of the level.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// Kept points in cells as wide as the spacing, so that all points nearer than the spacing to a place lie in the cell
/// of the place or in the 26 cells around it.
class KeptGrid {
 public:
  KeptGrid(double spacing, Vec3 corner);

  void add(Vec3 point);
  std::span<const Vec3> points() const { return points_; }
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

}  // namespace pointsweep
