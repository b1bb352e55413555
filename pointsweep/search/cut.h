// SPDX-License-Identifier: MIT
/// Cutting a slab top-down into cells, and cells into leaves, across the longest side of each piece.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/math/vec3.h"

namespace pointsweep {

/// The points of a slab in cut order: cell c holds order[begin[c] .. begin[c+1]), its leaves are consecutive runs
/// of 16.
struct Cut {
  std::vector<std::uint32_t> order;
  std::vector<std::uint32_t> begin;  ///< cells + 1 entries
  std::size_t cells() const { return begin.empty() ? 0 : begin.size() - 1; }
};

/// Cuts n points (n < 2^32) into cells of at most `cell_points` (a multiple of 16, at most kCellCapacity). The same
/// input gives the same cut. Points at one and the same place are ordered by row. About 50 ns per point.
void cut(std::span<const double> x, std::span<const double> y, std::span<const double> z,
         std::span<const std::uint64_t> row, std::uint32_t cell_points, Cut& out);

}  // namespace pointsweep
