// SPDX-License-Identifier: MIT
/// Square tiles in x and y.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace pointsweep {

/// Tile i of an axis holds [edge(i), edge(i + 1)), its lower edge included. edge(i) = origin + i * size in float64,
/// with one rounding for the product and one for the sum. So each finite coordinate is in exactly one tile, which
/// anybody can check by comparing float64 values.
class TileGrid {
 public:
  TileGrid(double size, const std::array<double, 2>& origin);

  double edge(std::size_t axis, std::int64_t tile) const { return origin_[axis] + static_cast<double>(tile) * size_; }
  /// Returns the tile of a finite coordinate. Throws UsageError if the edges of tiles near it are not distinct in
  /// float64.
  std::int64_t tile_of(std::size_t axis, double coordinate) const;
  /// Returns the lower edge as a decimal number with as many decimals as size and origin: "500", "-62.5".
  std::string edge_text(std::size_t axis, std::int64_t tile) const;

 private:
  double size_;
  std::array<double, 2> origin_;
  std::array<int, 2> digits_;  ///< digits after the decimal point, for x and y
};

}  // namespace pointsweep
