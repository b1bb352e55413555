// SPDX-License-Identifier: MIT
/// The cells of a raster that leaves out wide empty strips: places of rows and columns, and rows of values, of which
/// the filters of this folder read a few at a time.
///
/// Cells of an absolute grid have numbers floor(coordinate / cell). A strip of empty cells that is wider than the reach
/// of all filters is shortened or left out. A strip of columns is reduced until the columns on its two sides are
/// AxisRule::most places apart. A strip of rows is left out, and the rows on its two sides become separate rasters. So
/// an outlier far away does not make the raster large.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace pointsweep {

struct AxisRule {
  std::size_t margin;  ///< empty cells before the first number and after the last number
  std::size_t most;    ///< largest distance between the places of successive numbers, in cells
};

/// Places of row numbers that come in ascending order. A wide empty strip ends a band: numbers of different bands are
/// at least AxisRule::most cells apart.
class BandedRows {
 public:
  explicit BandedRows(AxisRule rule) : rule_(rule) {}
  /// Returns whether `number`, the next number for place_of(), ends a band and begins another. The first number of all
  /// ends no band.
  bool begins_band(double number) const;
  /// Returns the place of a number in its band. `number` must not be less than in the call before.
  std::uint64_t place_of(double number);
  /// Returns the number of the current band, counted from 0.
  std::size_t band() const { return band_; }
  /// Returns the number of places of the current band, with both margins; 0 before the first number.
  std::uint64_t rows() const { return any_ ? place_ + rule_.margin + 1 : 0; }

 private:
  AxisRule rule_;
  bool any_ = false;
  double number_ = 0;
  std::uint64_t place_ = 0;
  std::size_t band_ = 0;
};

/// Places of column numbers that come in any order: first all numbers are added, then places are queried.
class CellAxis {
 public:
  explicit CellAxis(AxisRule rule) : rule_(rule) {}
  void add(double number);
  /// Assigns the places. Must be called after the last add().
  void finish();
  /// Returns the place of a number that was added.
  std::size_t place_of(double number) const;
  /// Returns the number of places, with both margins; 0 if no number was added.
  std::size_t size() const { return size_; }

 private:
  /// A run of successive numbers.
  struct Run {
    double first, last;
    std::size_t place = 0;
  };
  void merge();

  AxisRule rule_;
  std::vector<double> added_;  ///< numbers that are not yet in runs_
  std::vector<Run> runs_;      ///< runs of the other added numbers, ascending
  std::size_t size_ = 0;
};

/// The value of an empty cell, and of a cell outside of the raster.
inline constexpr double kNoCell = std::numeric_limits<double>::infinity();

/// Successive rows of a raster.
struct CellRows {
  std::size_t rows = 0;
  std::vector<double> values;       ///< cell (r, c) at r * columns + c; finite or kNoCell
  std::vector<std::uint8_t> marks;  ///< in the same order; 1 if the value does not belong to the ground, else 0
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
/// Largest number of columns that a thread takes at once.
inline constexpr std::size_t kColumnsAtOnce = 512;

}  // namespace pointsweep
