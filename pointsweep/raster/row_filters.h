// SPDX-License-Identifier: MIT
/// Filters of the rows of a raster. One fills holes from the nearest cells on both sides in a row and in a column; the
/// other opens the surface by a disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "pointsweep/raster/cells.h"

namespace pointsweep {

/// Fills the unknown cells of a raster. A cell is known if it has a value and no mark. An unknown cell becomes the mean
/// of the nearest known cells west, east, south and north of it, each at most `reach` cells away, with the reciprocals
/// of their distances as weights:
///   ((W/w + E/e) + (S/s + N/n)) / ((1/w + 1/e) + (1/s + 1/n)), w, e, s, n: distances in cells.
/// A missing neighbour has no weight; without any neighbour the cell stays empty (kNoCell). Across a hole with two
/// sides this is linear interpolation. Exchanging rows and columns does not change any bit of the result. Marks are
/// dropped.
///
/// Pingel et al. (ground_surface.h) solve a system of springs over the whole raster (D'Errico, inpaint_nans), in which
/// every cell depends on every other cell.
class FilledRows final : public RowStream {
 public:
  FilledRows(std::unique_ptr<RowStream> from, std::size_t reach);
  bool next(CellRows& out) override;
  /// Returns the bytes of memory per column.
  static std::size_t column_bytes(std::size_t reach);

 private:
  bool take_rows();
  void fill_columns(std::size_t rows, std::size_t first, std::size_t end);
  void fill_row(std::size_t row, double* out) const;

  std::unique_ptr<RowStream> from_;
  std::size_t reach_;
  CellRows block_;
  bool ended_ = false;
  std::vector<double> known_;           ///< rows that are not returned yet, up to reach_ rows ahead; kNoCell: not known
  std::vector<double> south_;           ///< for each column, the last known value before known_
  std::vector<std::size_t> since_;      ///< for each column, rows since the value in south_; 0: none within reach
  std::vector<double> sums_, weights_;  ///< for each cell to be returned, sums over the known cells south and north
};

/// The cells with dx² + dy² <= radius² around a centre.
class Disk {
 public:
  explicit Disk(std::size_t radius);
  std::size_t radius() const { return half_widths_.size() - 1; }
  /// Returns the largest |dx| at the |dy| `dy`.
  std::size_t half_width(std::size_t dy) const { return half_widths_[dy]; }

 private:
  std::vector<std::size_t> half_widths_;  ///< half widths by |dy|, none greater than the one before
};

/// Minima over disks, for rows that come one after another. The minimum over a disk is the least of the minima over the
/// pieces of rows that form the disk.
class DiskMinima {
 public:
  DiskMinima(std::size_t radius, std::size_t columns) : disk_(radius), columns_(columns) {
    minima_.reserve(most_rows(radius) * columns);
  }

  /// Takes `rows` more rows, on all threads. Cells with kNoCell do not count.
  void add(const double* values, std::size_t rows);
  /// Returns the number of rows taken.
  std::size_t given() const { return given_; }
  /// Returns the number of rows of minima, dropped rows included, that no later row changes. `ended`: true if no row
  /// follows, so that all rows are complete.
  std::size_t complete(bool ended) const;
  double* row(std::size_t number) { return minima_.data() + (number - dropped_) * columns_; }
  /// Frees the rows of minima before `number`.
  void drop(std::size_t number);
  /// Returns the bytes of memory per column.
  static std::size_t column_bytes(std::size_t radius) { return most_rows(radius) * sizeof(double); }

 private:
  static std::size_t most_rows(std::size_t radius) { return 2 * (radius + kRowsAtOnce); }
  void add_part(const double* values, std::size_t rows, std::size_t first, std::size_t end);
  void spread(const double* values, std::size_t row, std::size_t half_width, std::size_t first, std::size_t end);

  Disk disk_;
  std::size_t columns_, given_ = 0, dropped_ = 0;
  std::vector<double> minima_;  ///< minima of the rows dropped_ to given_ + radius - 1
};

enum class Opens : std::uint8_t {
  surface,   ///< marks cells above the opened surface, and passes on the opened surface
  pit_marks  ///< marks cells below the opening of the negated surface, and passes on the surface unchanged
};

/// Opens a surface by a disk: an erosion (the least value within the radius), then a dilation of the eroded surface.
/// Marks a cell if it differs from the opened surface by more than `threshold`; earlier marks stay. Cells without a
/// value (kNoCell) are ignored and stay empty.
class OpenedRows final : public RowStream {
 public:
  OpenedRows(std::unique_ptr<RowStream> from, std::size_t radius, double threshold, Opens opens);
  bool next(CellRows& out) override;
  /// Returns the bytes of memory per column.
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
  std::vector<double> turned_;   ///< values that the next add() of eroded_ or dilated_ takes
  CellRows held_;                ///< rows that were taken and not returned yet
  std::size_t given_ = 0;        ///< number of rows returned
  DiskMinima eroded_, dilated_;  ///< erosion and dilation; dilation takes negated values
};

}  // namespace pointsweep
