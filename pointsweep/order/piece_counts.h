// SPDX-License-Identifier: MIT
/// One pass over a source that counts the points of each piece and stores no points.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/order/source.h"
#include "pointsweep/order/splitters.h"
#include "pointsweep/points/row_box.h"

namespace pointsweep {

/// A range of pieces; empty if first > last.
struct PieceRange {
  std::uint32_t first = ~std::uint32_t{0}, last = 0;

  bool empty() const { return first > last; }
  void include(std::uint32_t piece) {
    first = first < piece ? first : piece;
    last = last > piece ? last : piece;
  }
};

/// Rows that are decoded together, and for each Splitters the range of pieces that hold their points.
struct RowBlock {
  std::uint64_t first_row = 0, rows = 0;
  std::array<PieceRange, 2> pieces;
};

struct PieceCounts {
  std::vector<std::uint64_t> points;  ///< for each piece
  std::vector<Box> boxes;             ///< tight box of each piece
  std::uint64_t nonfinite = 0;        ///< number of points that are not finite, which belong to no piece
  std::vector<RowBlock> blocks;       ///< cover all rows, ascending
};

/// Cuts the rows of a source of `count` rows into blocks of at most `most` rows. A block does not cross the end of one
/// of the `boxes`, which ascend and do not overlap.
std::vector<RowBlock> cut_into_blocks(std::uint64_t count, std::uint64_t most, std::span<const RowBox> boxes);

/// Reads all `blocks` of the source on all threads; the source must have for_thread(). The counts do not depend on
/// threads. `progress` is called with the rows read, by one thread at a time.
PieceCounts count_pieces(const PointSource& source, const PieceFinder& finder, int axis, std::vector<RowBlock> blocks,
                         const std::function<void(std::uint64_t rows)>& progress);

}  // namespace pointsweep
