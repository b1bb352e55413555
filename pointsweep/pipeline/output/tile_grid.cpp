// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/output/tile_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

constexpr int kMostTileDigits = 17;
/// Least size of a tile relative to a coordinate. For larger tiles the edges are distinct in float64, and the rounded
/// quotient of a coordinate is the number of its tile or of a neighbour.
constexpr double kLeastPart = 0x1p-48;

/// Returns the least number of digits after the decimal point that represents the value exactly.
int digits_of(double value) {
  int digits = 0;
  while (digits < kMostTileDigits && std::strtod(fmt::format("{:.{}f}", value, digits).c_str(), nullptr) != value)
    ++digits;
  return digits;
}

}  // namespace

TileGrid::TileGrid(double size, const std::array<double, 2>& origin) : size_(size), origin_(origin), digits_{} {
  for (std::size_t axis = 0; axis < 2; ++axis) digits_[axis] = std::max(digits_of(size), digits_of(origin[axis]));
}

std::int64_t TileGrid::tile_of(std::size_t axis, double coordinate) const {
  const double origin = origin_[axis];
  if (!(size_ > kLeastPart * std::max(std::abs(coordinate), std::abs(origin))))
    fail_usage("--tile: tiles of {} have no edges that float64 tells apart at {} = {}; choose larger ones.", size_,
               "xy"[axis], coordinate);
  auto tile = static_cast<std::int64_t>(std::floor((coordinate - origin) / size_));
  while (coordinate < edge(axis, tile)) --tile;
  while (coordinate >= edge(axis, tile + 1)) ++tile;
  return tile;
}

std::string TileGrid::edge_text(std::size_t axis, std::int64_t tile) const {
  return fmt::format("{:.{}f}", edge(axis, tile) + 0.0, digits_[axis]);
}

}  // namespace pointsweep
