// SPDX-License-Identifier: MIT
#include "pointsweep/search/ball_raster.h"

#include <algorithm>
#include <cmath>

namespace pointsweep {

BallRaster::BallRaster(const Box& box, std::span<const Ball> balls) : lo_(box.lo) {
  divide(box.extent());
  marked_.resize(cells_[0] * cells_[1] * cells_[2]);
  for (const auto& [c, reach2] : balls) {
    const double r = safe_radius(reach2);
    std::array<std::size_t, 3> first, last;
    for (int a = 0; a < 3; ++a) first[a] = cell_of(a, c[a] - r), last[a] = cell_of(a, c[a] + r);
    for (std::size_t x = first[0]; x <= last[0]; ++x)
      for (std::size_t y = first[1]; y <= last[1]; ++y) {
        const auto row = marked_.begin() + static_cast<std::ptrdiff_t>((x * cells_[1] + y) * cells_[2]);
        std::fill(row + static_cast<std::ptrdiff_t>(first[2]), row + static_cast<std::ptrdiff_t>(last[2]) + 1, 1);
      }
  }
}

/// Divides the box into at most kMostCells cells of equal width along all axes, or of the whole width of the box along
/// an axis where the box is narrower.
void BallRaster::divide(Vec3 extent) {
  for (double width = std::max({extent.x, extent.y, extent.z}) / 2; width > 0; width /= 2) {
    std::array<double, 3> count;
    for (int a = 0; a < 3; ++a) count[a] = std::max(1.0, std::floor(extent[a] / width));
    if (!(count[0] * count[1] * count[2] <= kMostCells)) return;
    for (int a = 0; a < 3; ++a) {
      cells_[a] = static_cast<std::size_t>(count[a]);
      scale_[a] = count[a] > 1 ? count[a] / extent[a] : 0;
    }
  }
}

}  // namespace pointsweep
