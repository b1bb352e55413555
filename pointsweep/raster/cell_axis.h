// SPDX-License-Identifier: MIT
/// Numbers of rows and columns of a raster that leaves out wide empty strips.
///
/// Cells of an absolute grid have numbers floor(coordinate / cell). A strip of empty cells that is wider than the reach
/// of all filters is shortened. A strip of columns is reduced until the columns on its two sides are AxisRule::most
/// places apart. A strip of rows is left out, and the rows on its two sides become separate rasters. So an outlier far
/// away does not make the raster large.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pointsweep {

struct AxisRule {
  std::size_t margin;  ///< empty cells before the first number and after the last number
  std::size_t most;    ///< largest distance between the places of successive numbers, in cells
};

/// Places of numbers that come in ascending order, in bands. Numbers of different bands are at least `most` cells
/// apart.
class BandedRows {
 public:
  explicit BandedRows(AxisRule rule) : rule_(rule) {}
  /// Returns whether `number` is the first of a new band.
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

/// Places of numbers that come in any order: first all numbers are added, then places are queried.
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

}  // namespace pointsweep
