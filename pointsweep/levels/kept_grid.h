// SPDX-License-Identifier: MIT
/// Points that keep other points out of a level: those nearer than the spacing of the level.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// Points in cells as wide as the spacing, so that all points nearer than that to a place lie in the 27 cells around
/// it.
class KeptGrid {
 public:
  KeptGrid(double spacing, Vec3 corner);

  void add(Vec3 point);
  std::span<const Vec3> points() const { return points_; }
  /// Returns whether a point is nearer than the spacing.
  bool covers(Vec3 place) const;
  /// Replaces `near` by all points that may cover a place in the box, some of them maybe more than once.
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
  std::vector<std::uint32_t> next_;   ///< of a point in the chain of its bucket
  std::vector<std::uint32_t> first_;  ///< of a bucket; a power of two
};

}  // namespace pointsweep
