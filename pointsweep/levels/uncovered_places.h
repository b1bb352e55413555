// SPDX-License-Identifier: MIT
/// The places of a block that no kept point covers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/levels/kept_grid.h"

namespace pointsweep {

/// Halves the block recursively. A kept point near enough to all places of a half covers these places at once. The
/// places of a half are compared only with the kept points near that half.
class UncoveredPlaces {
 public:
  /// Returns the numbers of the uncovered places, ascending, valid until the next call. `box`: a box around all places.
  std::span<const std::uint32_t> find(std::span<const Vec3> places, const Box& box, const KeptGrid& kept);

 private:
  void find_in(std::size_t first, std::size_t count, std::size_t first_near);

  std::span<const Vec3> places_;
  double spacing2_ = 0;
  std::vector<Vec3> near_;  ///< a stack: the points near a half follow the points near the half that contains it
  std::vector<std::uint32_t> uncovered_;
};

}  // namespace pointsweep
