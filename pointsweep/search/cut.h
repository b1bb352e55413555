// SPDX-License-Identifier: MIT
/// Functions that cut a slab top-down into cells, and cells into leaves, across the longest side of each piece.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace pointsweep {

/// A point of a slab (a piece of the ordered point stream) while the slab is cut. The coordinates are relative to a
/// place near the slab, so that single precision suffices to choose sides; Cell::seal() computes boxes in double
/// precision.
struct alignas(16) CutPoint {
  std::array<float, 3> c;
  std::uint32_t index;  ///< number that the caller gives the point; the argument of `row_of`
};

/// Reorders fewer than 2^32 points into cells of at most `cell_points` (a multiple of 16, at most kCellCapacity): cell
/// c is points [begin[c], begin[c+1]). The same input gives the same cells. More than `cell_points` points at one place
/// are divided in the order of `row_of(index)`. About 30 ns per point.
void cut_into_cells(std::span<CutPoint> points, std::uint32_t cell_points,
                    const std::function<std::uint64_t(std::uint32_t index)>& row_of, std::vector<std::uint32_t>& begin);

/// Reorders points into cells as cut_into_cells() does, then cuts each cell into leaves with cut_into_leaves(). About
/// 60 ns per point.
void cut(std::span<CutPoint> points, std::uint32_t cell_points,
         const std::function<std::uint64_t(std::uint32_t index)>& row_of, std::vector<std::uint32_t>& begin);

/// Reorders at most kCellCapacity points so that consecutive runs of 16 are compact, by recursive halving across the
/// longest side, at a multiple of 16. Where all points of the cell, or of a piece of more than 16, coincide, they are
/// ordered by `row_of(index)` instead. The order is equal on every instruction set. About 30 ns per point.
void cut_into_leaves(std::span<CutPoint> points, const std::function<std::uint64_t(std::uint32_t index)>& row_of);

}  // namespace pointsweep
