// SPDX-License-Identifier: MIT
#include "pointsweep/search/ball_lookup.h"

#include <utility>

namespace pointsweep {
namespace {

/// The numbers of the cells of a grid, along one axis, from one end of a ball to the other. The ball is less than two
/// cells wide. Cells that lie between two adjacent doubles contain no point and are left out.
struct CellNumbers {
  std::array<double, 4> number;
  std::size_t count = 0;

  CellNumbers(double first, double last) {
    for (double n = first; n < last && count < number.size() - 1; n = std::max(n + 1, std::nextafter(n, last)))
      number[count++] = n;
    number[count++] = last;
  }
};

}  // namespace

BallCover::BallCover(std::span<const Ball> balls) : marked_(64) {
  for (const auto& [c, reach2] : balls) {
    const double r = safe_radius(reach2);
    if (!(r < kLargestRadius)) {
      is_unbounded_ = true;
      return;
    }
    BallGrid& grid = grid_with(std::ilogb(2 * r), grids_);
    const Box box{{c.x - r, c.y - r, c.z - r}, {c.x + r, c.y + r, c.z + r}};
    grid.bounds.include(box);
    const CellNumbers x(grid.cell_of(box.lo.x), grid.cell_of(box.hi.x));
    const CellNumbers y(grid.cell_of(box.lo.y), grid.cell_of(box.hi.y));
    const CellNumbers z(grid.cell_of(box.lo.z), grid.cell_of(box.hi.z));
    for (std::size_t i = 0; i < x.count; ++i)
      for (std::size_t j = 0; j < y.count; ++j)
        for (std::size_t k = 0; k < z.count; ++k) mark(grid.key_of(x.number[i], y.number[j], z.number[k]));
  }
}

bool BallCover::covers(Vec3 p) const {
  if (is_unbounded_) return true;
  return std::ranges::any_of(grids_, [&](const BallGrid& grid) {
    return distance2(grid.bounds, p) == 0 && marked_[find(grid.key_at(p))] != 0;
  });
}

std::size_t BallCover::find(std::uint64_t key) const {
  const std::size_t mask = marked_.size() - 1;
  std::size_t at = (key >> 1) & mask;
  while (marked_[at] != key && marked_[at] != 0) at = (at + 1) & mask;
  return at;
}

void BallCover::mark(std::uint64_t key) {
  std::uint64_t& place = marked_[find(key)];
  if (place == key) return;
  place = key;
  if (2 * ++count_ < marked_.size()) return;
  std::vector<std::uint64_t> fewer(2 * marked_.size());
  fewer.swap(marked_);
  for (const std::uint64_t other : fewer)
    if (other != 0) marked_[find(other)] = other;
}

std::size_t BallLookup::find(std::uint64_t key) const {
  const std::size_t mask = buckets_.size() - 1;
  std::size_t at = (key >> 1) & mask;
  while (buckets_[at].key != key && buckets_[at].key != 0) at = (at + 1) & mask;
  return at;
}

/// Enters each ball into the cells that it touches. Cells are at least twice as wide as a ball, so that the ends of the
/// ball lie in one cell or in two adjacent cells, even after rounding.
BallLookup::BallLookup(std::span<const Ball> balls) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> entries;  // key of a cell and number of a ball
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

/// Divides the box into at most kMostCells cells of about equal width along all axes. Along an axis where the box is
/// narrower than a cell, one cell has the width of the box.
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
