// SPDX-License-Identifier: MIT
/// Rows of cells of a raster, a few at a time: what flows through the filters of this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pointsweep {

/// The value of a cell that a raster does not have.
inline constexpr double kNoCell = std::numeric_limits<double>::infinity();

/// Successive rows, one after another, of as many cells as the raster has columns.
struct CellRows {
  std::size_t rows = 0;
  std::vector<double> values;       ///< rows × columns; finite or kNoCell
  std::vector<std::uint8_t> marks;  ///< rows × columns; 1: the value is not that of the ground
};

/// A source of rows from the first to the last.
class RowStream {
 public:
  explicit RowStream(std::size_t columns) : columns_(columns) {}
  virtual ~RowStream() = default;
  std::size_t columns() const { return columns_; }
  /// The next rows, at least one and as many as the stream finds convenient. False, and no rows, after the last.
  virtual bool next(CellRows& out) = 0;

 private:
  std::size_t columns_;
};

/// Rows that a source of rows makes at once.
inline constexpr std::size_t kRowsAtOnce = 16;
/// Columns that one thread takes at once.
inline constexpr std::size_t kColumnsAtOnce = 512;

}  // namespace pointsweep
