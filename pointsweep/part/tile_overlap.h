// SPDX-License-Identifier: MIT
/// The mean number of tiles whose boxes hold a point.
#pragma once

#include <cstdint>
#include <span>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// The box of a tile, which may be empty, and how many points lie in it.
struct TileExtent {
  Box box;
  std::uint64_t points = 0;
};

/// Returns in how many of the boxes a point lies on average, its own included, if the points of each tile lie evenly in
/// its box: 1 for tiles side by side. Cost: the square of the number of tiles, some nanoseconds a pair.
double mean_tiles_of_a_point(std::span<const TileExtent> tiles);

}  // namespace pointsweep
