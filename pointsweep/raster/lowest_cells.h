// SPDX-License-Identifier: MIT
/// The lowest z of each cell that has a point: the raster of minima, without its empty cells, in the temporary folder.
/// A wide empty strip of rows ends a band. Cells of different bands do not influence each other, so each band is a
/// separate raster with its own columns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "pointsweep/points/scratch.h"
#include "pointsweep/raster/cells.h"

namespace pointsweep {

/// A cell that has a point.
struct LowestCell {
  std::uint64_t row;  ///< place of the row in its band
  double column;      ///< number of the column
  double z;           ///< least z of the points of the cell
};

/// Takes points cell by cell, row by row.
class LowestCells {
 public:
  LowestCells(AxisRule rule, std::unique_ptr<Scratch> scratch);
  /// Takes a point of the cell with the numbers `row` and `column`. Points of a cell must follow one another, and rows
  /// must not descend.
  void add(double row, double column, double z);
  /// Must be called after the last add().
  void finish();

  std::size_t bands() const { return bands_.size(); }
  /// Returns the largest number of columns of a band.
  std::size_t most_columns() const { return most_columns_; }

 private:
  friend class CellBand;
  struct Band {
    std::uint64_t first, end;  ///< range of the cells of the band
    std::uint64_t rows;
  };
  void put();
  void end_band();
  void flush();
  /// Reads the cells `first`, `first` + 1, ... before `end`, with ascending rows; at most 4,096 cells.
  void read(std::uint64_t first, std::uint64_t end, std::vector<LowestCell>& out) const;

  AxisRule rule_;
  CellAxis columns_;  ///< columns of the current band
  BandedRows rows_;
  std::unique_ptr<Scratch> scratch_;
  std::vector<LowestCell> buffer_;
  std::vector<Band> bands_;
  LowestCell cell_{};
  double row_ = 0;  ///< number of the row of cell_
  bool any_ = false;
  std::uint64_t count_ = 0;
  std::size_t most_columns_ = 0;
};

/// A view of one band of a LowestCells, which must outlive the view.
class CellBand {
 public:
  CellBand(const LowestCells& cells, std::size_t number);
  const CellAxis& columns() const { return columns_; }
  std::uint64_t rows() const { return band_.rows; }
  std::uint64_t count() const { return band_.end - band_.first; }
  /// Returns the difference between the greatest and the least z of the cells.
  double height() const { return highest_ - lowest_; }
  /// Reads the cells `first`, `first` + 1, ... of the band, with ascending rows; at most 4,096 cells, and none after
  /// the last cell.
  void read(std::uint64_t first, std::vector<LowestCell>& out) const {
    cells_.read(band_.first + first, band_.end, out);
  }

 private:
  const LowestCells& cells_;
  LowestCells::Band band_;
  CellAxis columns_;
  double lowest_ = kNoCell, highest_ = -kNoCell;
};

/// The raster of minima of a band as rows: cells without a point have kNoCell, and no cell is marked. `band` must
/// outlive the stream.
class LowestRows final : public RowStream {
 public:
  explicit LowestRows(const CellBand& band) : RowStream(band.columns().size()), band_(band) {}
  bool next(CellRows& out) override;

 private:
  const CellBand& band_;
  std::uint64_t row_ = 0, read_ = 0;  ///< number of rows returned, number of cells read
  std::vector<LowestCell> buffer_;
  std::size_t at_ = 0;  ///< index of the next cell in buffer_
};

}  // namespace pointsweep
