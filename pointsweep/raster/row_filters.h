// SPDX-License-Identifier: MIT
/// Filters of the rows of a raster: holes are filled, and the surface is opened by a disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "pointsweep/raster/cell_rows.h"

namespace pointsweep {

/// A cell is known if it has a value and no mark. One that is not known becomes the mean of the nearest known cells
/// west, east, south and north of it, each at most `reach` cells away, with the reciprocals of their distances as
/// weights:
///   ((W/w + E/e) + (S/s + N/n)) / ((1/w + 1/e) + (1/s + 1/n)), w, e, s, n: distances in cells,
/// where what is missing counts 0; without any it has no value (kNoCell). Across a hole with two sides this is linear
/// interpolation. Rows and columns may be exchanged without a change of any bit. Marks are dropped.
///
/// Pingel et al. solve a system of springs over the whole raster (D'Errico, inpaint_nans), in which every cell depends
/// on every other.
class FilledRows final : public RowStream {
 public:
  FilledRows(std::unique_ptr<RowStream> from, std::size_t reach);
  bool next(CellRows& out) override;
  /// Memory for each column.
  static std::size_t column_bytes(std::size_t reach);

 private:
  bool take_rows();
  void fill_columns(std::size_t rows, std::size_t first, std::size_t end);
  void fill_row(std::size_t row, double* out) const;

  std::unique_ptr<RowStream> from_;
  std::size_t reach_;
  CellRows block_;
  bool ended_ = false;
  std::vector<double> known_;           ///< rows that are not given yet, up to reach_ rows ahead; kNoCell: not known
  std::vector<double> south_;           ///< by column, the last known value before these rows
  std::vector<std::size_t> since_;      ///< by column, how many rows before the next one that was; 0: none within reach
  std::vector<double> sums_, weights_;  ///< of the known cells south and north, of the rows to be given
};

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

enum class Opens : std::uint8_t {
  surface,   ///< marks cells above the opened surface, which goes on in place of the surface
  pit_marks  ///< marks cells below the opening of the surface upside down; the surface goes on unchanged
};

/// Marks a cell if it differs from the opened surface by more than `threshold`; earlier marks stay. Cells without a
/// value (kNoCell) count for nothing and stay so.
class OpenedRows final : public RowStream {
 public:
  OpenedRows(std::unique_ptr<RowStream> from, std::size_t radius, double threshold, Opens opens);
  bool next(CellRows& out) override;
  /// Memory for each column.
  static std::size_t column_bytes(std::size_t radius);

 private:
  static std::size_t most_held(std::size_t radius) { return 2 * (radius + kRowsAtOnce); }
  double turned(double value) const;
  void take_rows();
  void dilate();
  void give(std::size_t rows, CellRows& out);

  std::unique_ptr<RowStream> from_;
  double threshold_;
  bool upside_down_, ended_ = false;
  CellRows block_;
  std::vector<double> turned_;   ///< the rows that came, as they are opened
  CellRows held_;                ///< rows that came and are not given yet; `rows` of them
  std::size_t given_ = 0;        ///< rows given
  DiskMinima eroded_, dilated_;  ///< the second of negated values
};

}  // namespace pointsweep
