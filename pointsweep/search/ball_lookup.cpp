// SPDX-License-Identifier: MIT
#include "pointsweep/search/ball_lookup.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace pointsweep {

std::size_t BallLookup::find(std::uint64_t key) const {
  const std::size_t mask = buckets_.size() - 1;
  std::size_t at = (key >> 1) & mask;
  while (buckets_[at].key != key && buckets_[at].key != 0) at = (at + 1) & mask;
  return at;
}

/// Cells are at least twice as wide as the ball, so that its ends, with all rounding, are in one cell or in two
/// adjacent ones.
BallLookup::BallLookup(std::span<const Ball> balls) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> entries;  // key, number
  for (std::uint32_t number = 0; number < balls.size(); ++number) {
    const auto& [c, reach2] = balls[number];
    const double r = safe_radius(reach2);
    if (!(r < kLargestRadius)) {
      unbounded_.push_back(number);
      continue;
    }
    BallGrid& grid = grid_with(std::ilogb(2 * r) + 2, grids_);
    const Box box{{c.x - r, c.y - r, c.z - r}, {c.x + r, c.y + r, c.z + r}};
    grid.bounds.include(box);
    double ends[3][2];
    for (int a = 0; a < 3; ++a) ends[a][0] = grid.cell_of(box.lo[a]), ends[a][1] = grid.cell_of(box.hi[a]);
    for (unsigned corner = 0; corner < 8; ++corner) {
      const bool twice = (corner & 1 && ends[0][0] == ends[0][1]) || (corner & 2 && ends[1][0] == ends[1][1]) ||
                         (corner & 4 && ends[2][0] == ends[2][1]);
      if (twice) continue;
      entries.emplace_back(grid.key_of(ends[0][corner & 1], ends[1][corner >> 1 & 1], ends[2][corner >> 2]), number);
    }
  }
  std::ranges::sort(entries);
  const auto [gone, end] = std::ranges::unique(entries);  // two cells of a ball may share a key
  entries.erase(gone, end);
  buckets_.resize(std::bit_ceil(2 * entries.size() + 1));
  for (const auto& [key, number] : entries) {
    Bucket& bucket = buckets_[find(key)];
    if (bucket.key == 0) bucket = {key, static_cast<std::uint32_t>(numbers_.size()), 0};
    ++bucket.count;
    numbers_.push_back(number);
  }
}

}  // namespace pointsweep
