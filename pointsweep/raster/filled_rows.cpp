// SPDX-License-Identifier: MIT
/// Fills holes of a raster from the nearest cells on both sides in its row and in its column.
#include <algorithm>
#include <utility>

#include "pointsweep/raster/row_filters.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

/// The nearest known cell on one side: its value, and its distance in cells, which is 0 if no known cell is within
/// reach.
struct Side {
  double value = 0;
  std::size_t distance = 0;

  /// Moves on by one cell, to a cell with the value `next`; kNoCell if the cell is not known.
  void pass(double next, std::size_t reach) {
    if (next != kNoCell)
      *this = {next, 1};
    else if (distance != 0)
      distance = distance < reach ? distance + 1 : 0;
  }
  double term() const { return distance == 0 ? 0 : value / static_cast<double>(distance); }
  double weight() const { return distance == 0 ? 0 : 1 / static_cast<double>(distance); }
};

}  // namespace

FilledRows::FilledRows(std::unique_ptr<RowStream> from, std::size_t reach)
    : RowStream(from->columns()), from_(std::move(from)), reach_(reach), south_(columns()), since_(columns()) {
  known_.reserve((reach + 2 * kRowsAtOnce) * columns());
}

std::size_t FilledRows::column_bytes(std::size_t reach) {
  return (reach + 6 * kRowsAtOnce) * sizeof(double) + 2 * kRowsAtOnce + 2 * sizeof(double);
}

bool FilledRows::take_rows() {
  if (ended_ || !from_->next(block_)) {
    ended_ = true;
    return false;
  }
  for (std::size_t i = 0; i < block_.values.size(); ++i)
    known_.push_back(block_.marks[i] != 0 ? kNoCell : block_.values[i]);
  return true;
}

bool FilledRows::next(CellRows& out) {
  while (known_.size() < (reach_ + kRowsAtOnce) * columns() && take_rows()) {
  }
  const std::size_t held = columns() == 0 ? 0 : known_.size() / columns();
  out.rows = std::min(held, kRowsAtOnce);
  out.values.resize(out.rows * columns());
  out.marks.assign(out.rows * columns(), 0);
  sums_.resize(out.values.size());
  weights_.resize(out.values.size());
  parallel_for((columns() + kColumnsAtOnce - 1) / kColumnsAtOnce, [&](std::size_t part, unsigned) {
    const std::size_t first = part * kColumnsAtOnce;
    fill_columns(out.rows, first, std::min(columns(), first + kColumnsAtOnce));
  });
  parallel_for(out.rows, [&](std::size_t row, unsigned) { fill_row(row, out.values.data() + row * columns()); });
  known_.erase(known_.begin(), known_.begin() + static_cast<std::ptrdiff_t>(out.rows * columns()));
  return out.rows > 0;
}

/// Adds the contributions of the columns `first` to `end` to the sums, row by row.
void FilledRows::fill_columns(std::size_t rows, std::size_t first, std::size_t end) {
  std::vector<Side> sides(end - first);
  for (std::size_t row = std::min(known_.size() / columns(), rows + reach_); row-- > 0;) {
    for (std::size_t c = first; c < end; ++c) {
      Side& north = sides[c - first];
      if (row < rows) {
        sums_[row * columns() + c] = north.term();
        weights_[row * columns() + c] = north.weight();
      }
      north.pass(known_[row * columns() + c], reach_);
    }
  }
  for (std::size_t c = first; c < end; ++c) sides[c - first] = {south_[c], since_[c]};
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t c = first; c < end; ++c) {
      Side& south = sides[c - first];
      sums_[row * columns() + c] += south.term();
      weights_[row * columns() + c] += south.weight();
      south.pass(known_[row * columns() + c], reach_);
    }
  }
  for (std::size_t c = first; c < end; ++c) south_[c] = sides[c - first].value, since_[c] = sides[c - first].distance;
}

void FilledRows::fill_row(std::size_t row, double* out) const {
  const double* known = known_.data() + row * columns();
  const double* sums = sums_.data() + row * columns();
  const double* weights = weights_.data() + row * columns();
  std::vector<Side> east(columns());
  Side side;
  for (std::size_t c = columns(); c-- > 0;) {
    east[c] = side;
    side.pass(known[c], reach_);
  }
  side = {};
  for (std::size_t c = 0; c < columns(); ++c) {
    const double sum = (side.term() + east[c].term()) + sums[c];
    const double weight = (side.weight() + east[c].weight()) + weights[c];
    out[c] = known[c] != kNoCell ? known[c] : weight > 0 ? sum / weight : kNoCell;
    side.pass(known[c], reach_);
  }
}

}  // namespace pointsweep
