// SPDX-License-Identifier: MIT
/// Minima over disks of cells, from minima over pieces of rows.
#pragma once

#include <cstddef>
#include <vector>

#include "pointsweep/raster/cell_rows.h"

namespace pointsweep {

/// The cells at most `radius` cells from a centre: those with dx² + dy² <= radius².
class Disk {
 public:
  explicit Disk(std::size_t radius);
  std::size_t radius() const { return half_widths_.size() - 1; }
  /// The largest |dx| at this |dy|.
  std::size_t half_width(std::size_t dy) const { return half_widths_[dy]; }

 private:
  std::vector<std::size_t> half_widths_;  ///< by |dy|; they do not ascend
};

/// Rows whose cells become minima over disks around them, while rows are given from the first to the last.
class DiskMinima {
 public:
  DiskMinima(std::size_t radius, std::size_t columns) : disk_(radius), columns_(columns) {
    minima_.reserve(most_rows(radius) * columns);
  }

  /// Takes `rows` rows more; kNoCell counts for nothing. On all threads.
  void add(const double* values, std::size_t rows);
  /// Rows taken.
  std::size_t given() const { return given_; }
  /// Rows that no later row changes, with those dropped: all of them if `ended`, that is, if no row follows.
  std::size_t complete(bool ended) const;
  double* row(std::size_t number) { return minima_.data() + (number - dropped_) * columns_; }
  /// Forgets the rows before `number`.
  void drop(std::size_t number);
  /// Memory for each column.
  static std::size_t column_bytes(std::size_t radius) { return most_rows(radius) * sizeof(double); }

 private:
  static std::size_t most_rows(std::size_t radius) { return 2 * (radius + kRowsAtOnce); }
  void add_part(const double* values, std::size_t rows, std::size_t first, std::size_t end);
  void spread(const double* values, std::size_t row, std::size_t half_width, std::size_t first, std::size_t end);

  Disk disk_;
  std::size_t columns_, given_ = 0, dropped_ = 0;
  std::vector<double> minima_;  ///< minima of the rows dropped_ to given_ + radius
};

}  // namespace pointsweep
