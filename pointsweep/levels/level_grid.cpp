// SPDX-License-Identifier: MIT
#include "pointsweep/levels/level_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "pointsweep/math/mix.h"

namespace pointsweep {
namespace {

constexpr double kCells = std::uint32_t{1} << kMostDepth;

double unit_of(Vec3 scale) {
  const double longest = std::max({scale.x, scale.y, scale.z});
  return longest / scale.x <= 0x1p30 ? scale.x : longest;
}

/// Returns the least width of at least `steps` that is a whole number from 8 to 16 times a power of two, or a multiple
/// of 8 below 128.
double even_width(double steps) {
  const auto whole = static_cast<std::uint64_t>(std::ceil(steps));
  const int bits = std::max(7, static_cast<int>(std::bit_width(whole)));
  const std::uint64_t unit = std::uint64_t{8} << (bits - 7);
  return static_cast<double>((whole + unit - 1) / unit * unit);
}

}  // namespace

LevelGrid::LevelGrid(const GridBounds& bounds, Vec3 scale)
    : scale_(scale),
      lo_{static_cast<double>(bounds.lo[0]), static_cast<double>(bounds.lo[1]), static_cast<double>(bounds.lo[2])},
      unit_(unit_of(scale)),
      step_{scale.x / unit_, scale.y / unit_, scale.z / unit_} {
  const Vec3 last = place(bounds.hi) + 0.5 * step_;
  width_ = even_width(std::max({last.x, last.y, last.z}));
  cells_per_step_ = kCells / width_;
}

std::uint32_t LevelGrid::cell(double place) const {
  return static_cast<std::uint32_t>(std::min(place * cells_per_step_, kCells - 1));
}

CurveKey LevelGrid::key(const GridPoint& point) const {
  const Vec3 at = place(point);
  return key_of_cell({cell(at.x), cell(at.y), cell(at.z)});
}

Box LevelGrid::box(const Octant& octant) const {
  const double edge = std::ldexp(width_, -octant.depth);
  const Vec3 lo = edge * Vec3{static_cast<double>(octant.at[0]), static_cast<double>(octant.at[1]),
                              static_cast<double>(octant.at[2])};
  return {lo, lo + Vec3{edge, edge, edge}};
}

Vec3 LevelGrid::corner(Vec3 offset) const {
  return {(lo_.x - 0.5) * scale_.x + offset.x, (lo_.y - 0.5) * scale_.y + offset.y,
          (lo_.z - 0.5) * scale_.z + offset.z};
}

std::uint64_t rank_of(const GridPoint& point) {
  const auto bits = [&](std::size_t axis) { return std::uint64_t{static_cast<std::uint32_t>(point[axis])}; };
  return mix(mix(bits(0) | bits(1) << 32) ^ bits(2));
}

}  // namespace pointsweep
