// SPDX-License-Identifier: MIT
/// Fills holes of a raster from the nearest cells on both sides in its row and in its column.
#pragma once

#include <cstddef>
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

}  // namespace pointsweep
