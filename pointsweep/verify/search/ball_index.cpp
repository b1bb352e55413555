// SPDX-License-Identifier: MIT
#include "pointsweep/verify/search/ball_index.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "pointsweep/cancellation.h"
#include "pointsweep/math/box.h"

namespace pointsweep {
namespace {

constexpr int kFinest = 30;  ///< a grid has at most 2^30 cells along an axis

/// Returns slightly more than the square root, so that rounding, also of squares below the range of double, excludes no
/// point.
double radius_of(double reach2) { return std::sqrt(reach2) * (1 + 1e-9) + 1e-150; }

/// Returns the level of the finest grid over `extent` whose cells are at least `width` wide.
int level_of(double width, double extent) {
  int level = 0;
  while (level < kFinest && std::ldexp(extent, -(level + 1)) >= width) ++level;
  return level;
}

}  // namespace

BallIndex::BallIndex(const std::vector<Vec3>& centers, const std::vector<double>& reach2) {
  Box box;
  for (const Vec3 c : centers) box.include(c);
  low_ = box.lo;
  const Vec3 size = box.extent();
  const double extent = std::max({size.x, size.y, size.z});
  std::vector<double> radius;
  std::array<std::vector<std::uint32_t>, kFinest + 1> levels;
  for (std::size_t i = 0; i < centers.size(); ++i) {
    radius.push_back(radius_of(reach2[i]));
    levels[static_cast<std::size_t>(level_of(2 * radius[i], extent))].push_back(static_cast<std::uint32_t>(i));
  }
  for (int level = 0; level <= kFinest; ++level) {
    const auto& members = levels[static_cast<std::size_t>(level)];
    if (members.empty()) continue;
    Grid& grid = grids_.emplace_back();
    grid.per_length = extent > 0 ? std::ldexp(1 / extent, level) : 0;
    grid.last = std::ldexp(1, level);
    fill(grid, members, centers, radius);
  }
}

void BallIndex::fill(Grid& grid, const std::vector<std::uint32_t>& members, const std::vector<Vec3>& centers,
                     const std::vector<double>& radius) const {
  grid.mask = std::bit_ceil(static_cast<std::uint32_t>(members.size()) * 8) - 1;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> entries;  // number of a bucket and number of a ball
  std::vector<std::uint32_t> buckets;
  for (const std::uint32_t ball : members) {
    stop_if_cancelled();
    const Vec3 c = centers[ball];
    const double r = radius[ball];
    const Cell lo = grid.cell({c.x - r, c.y - r, c.z - r}, low_), hi = grid.cell({c.x + r, c.y + r, c.z + r}, low_);
    buckets.clear();
    for (std::uint32_t x = lo[0]; x <= hi[0]; ++x)
      for (std::uint32_t y = lo[1]; y <= hi[1]; ++y)
        for (std::uint32_t z = lo[2]; z <= hi[2]; ++z) buckets.push_back(grid.bucket({x, y, z}));
    std::ranges::sort(buckets);
    buckets.erase(std::unique(buckets.begin(), buckets.end()), buckets.end());
    for (const std::uint32_t bucket : buckets) entries.emplace_back(bucket, ball);
  }
  std::ranges::sort(entries);
  grid.begin.assign(std::size_t{grid.mask} + 2, 0);
  for (const auto& [bucket, ball] : entries) ++grid.begin[bucket + 1], grid.balls.push_back(ball);
  for (std::size_t b = 1; b < grid.begin.size(); ++b) grid.begin[b] += grid.begin[b - 1];
}

}  // namespace pointsweep
