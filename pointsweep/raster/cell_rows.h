// SPDX-License-Identifier: MIT
/// Rows of cells of a raster, which flow through the filters of this folder a few at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pointsweep {

/// The value of a cell that a raster does not have.
inline constexpr double kNoCell = std::numeric_limits<double>::infinity();

/// Successive rows of a raster.
struct CellRows {
  std::size_t rows = 0;
  std::vector<double> values;       ///< rows × columns; finite or kNoCell
  std::vector<std::uint8_t> marks;  ///< rows × columns; 1 if the value does not belong to the ground, else 0
};

/// A source of rows from the first to the last.
class RowStream {
 public:
  explicit RowStream(std::size_t columns) : columns_(columns) {}
  virtual ~RowStream() = default;
  std::size_t columns() const { return columns_; }
  /// Reads the next rows, at least one; the stream chooses how many. Returns false, and no rows, after the last row.
  virtual bool next(CellRows& out) = 0;

 private:
  std::size_t columns_;
};

/// Number of rows that LowestRows and FilledRows make at once, except for fewer last rows.
inline constexpr std::size_t kRowsAtOnce = 16;
/// Number of columns that a thread takes at once.
inline constexpr std::size_t kColumnsAtOnce = 512;

}  // namespace pointsweep
