// SPDX-License-Identifier: MIT
/// Pieces of the stream: the limits between them along the axis, from the quantiles of a sample; the piece of a point;
/// and a pass over a source that counts the points of each piece and stores no points.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/order/local_spacing.h"
#include "pointsweep/order/source.h"
#include "pointsweep/points/row_box.h"

namespace pointsweep {

/// Divides the real line into pieces. Piece p holds the finite values v with limits[p-1] <= v < limits[p].
class Splitters {
 public:
  /// Makes one piece of all values.
  Splitters() : Splitters(std::vector<double>()) {}
  /// `limits` must ascend strictly and have at most 65,534 values.
  explicit Splitters(std::vector<double> limits);

  std::size_t pieces() const { return limits_.size(); }

  /// Returns the piece of a value, exactly. Takes one table look-up and two comparisons; few values need a search.
  std::uint32_t piece_of(double value) const {
    const std::size_t cell = cell_of(value);
    std::uint32_t piece = first_[cell];
    piece += limits_[piece] <= value;
    if (limits_[piece] <= value) [[unlikely]]
      piece = search(cell, value);
    return piece;
  }

 private:
  /// Returns the entry of the look-up table for a value. Monotonic in spite of rounding: the limits in lower entries
  /// are below the value, and the limits in higher entries above it.
  std::size_t cell_of(double value) const {
    const double cell = (value - lo_) * scale_;
    return static_cast<std::size_t>(cell > 0 ? std::min(cell, last_cell_) : 0.0);
  }
  std::uint32_t search(std::size_t cell, double value) const;

  std::vector<double> limits_;        ///< the limits, then infinity, which exceeds all values
  std::vector<std::uint16_t> first_;  ///< look-up table: number of limits in lower entries; one more entry at the end
  double lo_ = 0, scale_ = 0, last_cell_ = 0;
};

/// Finds the piece of a point. A second Splitters may exist for points in sparse places; its pieces are numbered after
/// those of the first.
class PieceFinder {
 public:
  /// Borrows `splitters` and `spacing`. `spacing` tells which places are sparse; null if there is one Splitters.
  PieceFinder(std::span<const Splitters> splitters, const LocalSpacing* spacing)
      : splitters_(splitters), spacing_(spacing) {}

  std::size_t pieces() const { return first_sparse_piece() + (splitters_.size() > 1 ? splitters_[1].pieces() : 0); }
  std::size_t first_sparse_piece() const { return splitters_[0].pieces(); }

  /// Returns the piece of a point. `p` must be finite; `key` is the value that the splitters divide.
  std::size_t piece_of(Vec3 p, double key) const {
    if (splitters_.size() > 1 && spacing_->is_sparse(p)) return first_sparse_piece() + splitters_[1].piece_of(key);
    return splitters_[0].piece_of(key);
  }

 private:
  std::span<const Splitters> splitters_;
  const LocalSpacing* spacing_;
};

/// Returns at most `pieces` - 1 quantiles of a sample. A value that fills more than one piece gets its own piece, which
/// another key can split. Sorts the sample.
std::vector<double> quantile_limits(std::vector<double>& sample, std::size_t pieces);

/// Returns the subset of the ascending `limits` that leaves every piece but the last at least as thick as four times
/// the median spacing of its points. Most points of thinner slabs would have neighbours in other slabs. `sample` has
/// coordinates along the axis, `spacing` the spacing at each sample point; an empty `spacing` keeps all limits.
std::vector<double> limits_not_too_near(std::span<const double> limits, std::span<const double> sample,
                                        std::span<const double> spacing);

/// A range of pieces; empty if first > last.
struct PieceRange {
  std::uint32_t first = ~std::uint32_t{0}, last = 0;

  bool empty() const { return first > last; }
  void include(std::uint32_t piece) {
    first = first < piece ? first : piece;
    last = last > piece ? last : piece;
  }
};

/// Rows that are decoded together, and for each Splitters the range of pieces that hold their points.
struct RowBlock {
  std::uint64_t first_row = 0, rows = 0;
  std::array<PieceRange, 2> pieces;
};

struct PieceCounts {
  std::vector<std::uint64_t> points;  ///< number of points of each piece
  std::vector<Box> boxes;             ///< tight box of each piece
  std::uint64_t nonfinite = 0;        ///< number of points that are not finite, which belong to no piece
  std::vector<RowBlock> blocks;       ///< cover all rows, ascending
};

/// Cuts the rows of a source of `count` rows into blocks of at most `most` rows. No block crosses the end of
/// the rows of one of the `boxes`, which ascend by row and have no common rows.
std::vector<RowBlock> cut_into_blocks(std::uint64_t count, std::uint64_t most, std::span<const RowBox> boxes);

/// Reads all `blocks` of the source on all threads; the source must have for_thread(). The result does not depend
/// on the number of threads. One thread at a time calls `progress` with the number of rows read so far.
PieceCounts count_pieces(const PointSource& source, const PieceFinder& finder, int axis, std::vector<RowBlock> blocks,
                         const std::function<void(std::uint64_t rows)>& progress);

}  // namespace pointsweep
