// SPDX-License-Identifier: MIT
/// Rows of cells of a raster, which flow through the filters of this folder a few at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
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

/// The few rows of a surface around the row of the current points.
class SurfaceWindow {
 public:
  /// Keeps the row of move_to(), and the rows up to `around` before and after it, in memory.
  SurfaceWindow(std::unique_ptr<RowStream> from, std::size_t around) : from_(std::move(from)), around_(around) {}
  /// Moves the window to a row, which must not be earlier than the row of the last call.
  void move_to(std::uint64_t row);
  /// Returns the value of a cell; kNoCell outside of the raster or of the rows in memory.
  double at(std::uint64_t row, std::size_t column) const {
    const std::size_t columns = from_->columns();
    if (row < first_ || row - first_ >= rows_ || column >= columns) return kNoCell;
    return values_[static_cast<std::size_t>(row - first_) * columns + column];
  }

 private:
  std::unique_ptr<RowStream> from_;
  std::size_t around_;
  std::uint64_t first_ = 0;  ///< number of the first row in memory
  std::size_t rows_ = 0;
  bool ended_ = false;
  std::vector<double> values_;
  CellRows block_;
};

}  // namespace pointsweep
