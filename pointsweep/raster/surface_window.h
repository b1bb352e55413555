// SPDX-License-Identifier: MIT
/// The few rows of a surface around the row of the current points.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "pointsweep/raster/cell_rows.h"

namespace pointsweep {

class SurfaceWindow {
 public:
  /// Keeps the row of move_to(), and the rows up to `around` before and after it, in memory.
  SurfaceWindow(std::unique_ptr<RowStream> from, std::size_t around) : from_(std::move(from)), around_(around) {}
  /// Moves the window to a row, which must not be earlier than the row of the last call.
  void move_to(std::uint64_t row);
  /// Returns the value of a cell; kNoCell outside of the raster.
  double at(std::uint64_t row, std::size_t column) const {
    const std::size_t columns = from_->columns();
    if (row < first_ || row - first_ >= rows_ || column >= columns) return kNoCell;
    return values_[static_cast<std::size_t>(row - first_) * columns + column];
  }

 private:
  std::unique_ptr<RowStream> from_;
  std::size_t around_;
  std::uint64_t first_ = 0;  ///< the number of the first row in memory
  std::size_t rows_ = 0;
  bool ended_ = false;
  std::vector<double> values_;
  CellRows block_;
};

}  // namespace pointsweep
