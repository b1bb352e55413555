// SPDX-License-Identifier: MIT
/// Grids of cells for balls of similar size. The sizes of cells are powers of two.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/math/mix.h"

namespace pointsweep {

/// Set of the points within sqrt(reach2) of a place, by distance2() in double.
struct Ball {
  Vec3 center;
  double reach2;
};

/// Returns a radius that no point of the ball exceeds along an axis, in spite of the rounding of squares.
inline double safe_radius(double reach2) { return std::sqrt(reach2) * (1 + 1e-12) + 1e-150; }

/// Balls with a larger radius belong to no grid.
inline constexpr double kLargestRadius = 1e150;

struct BallGrid {
  int exponent;  ///< cells are 2^exponent wide
  double scale;  ///< 2^-exponent
  Box bounds;    ///< box of the balls

  /// Returns the number of a cell along an axis. If the grid is finer than doubles are apart, numbers of adjacent
  /// doubles are adjacent doubles.
  double cell_of(double coordinate) const { return std::floor(coordinate * scale); }
  /// Returns the key of a cell, which is never 0. Two cells may share a key.
  std::uint64_t key_of(double x, double y, double z) const {
    const auto bits = [](double c) { return std::bit_cast<std::uint64_t>(c + 0.0); };  // -0 is 0
    return mix(bits(x) * 0x9e3779b97f4a7c15u + bits(y) * 0xc2b2ae3d27d4eb4fu + bits(z) * 0x165667b19e3779f9u +
               static_cast<std::uint64_t>(exponent)) |
           1;
  }
  std::uint64_t key_at(Vec3 p) const { return key_of(cell_of(p.x), cell_of(p.y), cell_of(p.z)); }
};

/// Returns the grid of that exponent, and makes it if it is missing.
inline BallGrid& grid_with(int exponent, std::vector<BallGrid>& grids) {
  for (BallGrid& grid : grids)
    if (grid.exponent == exponent) return grid;
  return grids.emplace_back(BallGrid{exponent, std::ldexp(1.0, -exponent), {}});
}

}  // namespace pointsweep
