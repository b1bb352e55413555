// SPDX-License-Identifier: MIT
#include "pointsweep/part/tile_overlap.h"

#include <algorithm>

namespace pointsweep {
namespace {

/// Returns the share of the volume of `box` that `other` covers, in [0, 1].
double covered_share(const Box& box, const Box& other) {
  double share = 1;
  for (int a = 0; a < 3 && share > 0; ++a) {
    const double common = std::min(box.hi[a], other.hi[a]) - std::max(box.lo[a], other.lo[a]);
    const double length = box.hi[a] - box.lo[a];
    share *= common < 0 ? 0 : length > 0 ? common / length : 1;
  }
  return share;
}

}  // namespace

double mean_tiles_of_a_point(std::span<const TileExtent> tiles) {
  double points = 0, covered = 0;
  for (const TileExtent& tile : tiles) {
    if (tile.box.empty()) continue;
    const auto n = static_cast<double>(tile.points);
    points += n;
    for (const TileExtent& other : tiles)
      if (!other.box.empty()) covered += n * covered_share(tile.box, other.box);
  }
  return points > 0 ? covered / points : 1;
}

}  // namespace pointsweep
