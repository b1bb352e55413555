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

/// Halves the block again and again. One kept point near enough to all of a half covers it at once; only the kept
/// points that are near a half are looked at for its places.
class UncoveredPlaces {
 public:
  /// Returns the numbers of the places, ascending, until the next call. `box`: around all of them.
  std::span<const std::uint32_t> find(std::span<const Vec3> places, const Box& box, const KeptGrid& kept);

 private:
  void find_in(std::size_t first, std::size_t count, std::size_t first_near);

  std::span<const Vec3> places_;
  double spacing2_ = 0;
  std::vector<Vec3> near_;  ///< those of each half behind those of the half around it
  std::vector<std::uint32_t> uncovered_;
};

}  // namespace pointsweep
