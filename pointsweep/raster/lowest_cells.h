// SPDX-License-Identifier: MIT
/// The lowest z of each cell that has a point: the raster of minima, without its empty cells, in the temporary folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "pointsweep/points/scratch.h"
#include "pointsweep/raster/cell_axis.h"
#include "pointsweep/raster/cell_rows.h"

namespace pointsweep {

/// A cell that has a point.
struct LowestCell {
  std::uint64_t row;  ///< its place
  double column;      ///< its number
  double z;           ///< the least of its points
};

/// Takes points cell by cell, row by row.
class LowestCells {
 public:
  LowestCells(AxisRule rule, std::unique_ptr<Scratch> scratch);
  /// `row` and `column` are the numbers of the cell. Points of a cell follow one another, and rows ascend.
  void add(double row, double column, double z);
  /// After the last point.
  void finish();

  const CellAxis& columns() const { return columns_; }
  std::uint64_t rows() const { return rows_.size(); }
  std::uint64_t count() const { return count_; }
  /// Cells `first`, `first` + 1, ... in their order: ascending rows. At most 4,096, and none behind the last.
  void read(std::uint64_t first, std::vector<LowestCell>& out) const;

 private:
  void put();
  void flush();

  CellAxis columns_;
  AscendingPlaces rows_;
  std::unique_ptr<Scratch> scratch_;
  std::vector<LowestCell> buffer_;
  LowestCell cell_{};
  double row_ = 0;  ///< number of the row of cell_
  bool any_ = false;
  std::uint64_t count_ = 0;
};

/// The raster of minima: cells without a point have kNoCell, and no cell is marked. `cells` must outlive it.
class LowestRows final : public RowStream {
 public:
  explicit LowestRows(const LowestCells& cells) : RowStream(cells.columns().size()), cells_(cells) {}
  bool next(CellRows& out) override;

 private:
  const LowestCells& cells_;
  std::uint64_t row_ = 0, read_ = 0;  ///< rows given, cells read
  std::vector<LowestCell> buffer_;
  std::size_t at_ = 0;  ///< the next cell of buffer_
};

}  // namespace pointsweep
