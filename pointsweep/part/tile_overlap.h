// SPDX-License-Identifier: MIT
/// The mean number of tiles whose boxes hold a point.
#pragma once

#include <cstdint>
#include <span>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// The box of a tile, which may be empty, and the number of points of the tile.
struct TileExtent {
  Box box;
  std::uint64_t points = 0;
};

/// Returns the mean number of tile boxes that contain a point: 1 for tiles side by side. Assumes that the points of a
/// tile are spread evenly over its box. Cost: some nanoseconds for each pair of tiles.
double mean_tiles_of_a_point(std::span<const TileExtent> tiles);

}  // namespace pointsweep
