// SPDX-License-Identifier: MIT
#include "pointsweep/raster/row_filters.h"

#include <algorithm>
#include <utility>

#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

/// The nearest known cell on one side: its value, and its distance in cells, which is 0 if no known cell is within
/// reach.
struct Side {
  double value = 0;
  std::size_t distance = 0;

  /// Moves on past a cell with the value `next`; kNoCell if that cell is not known.
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
  parallel_for_blocks(columns(), kColumnsAtOnce,
                      [&](std::size_t first, std::size_t n, unsigned) { fill_columns(out.rows, first, first + n); });
  parallel_for(out.rows, [&](std::size_t row, unsigned) { fill_row(row, out.values.data() + row * columns()); });
  known_.erase(known_.begin(), known_.begin() + static_cast<std::ptrdiff_t>(out.rows * columns()));
  return out.rows > 0;
}

/// Sets the sums and weights of the cells in the columns `first` to `end` - 1 from the nearest known cells north and
/// south of each cell.
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

Disk::Disk(std::size_t radius) {
  for (std::size_t dy = 0, dx = radius; dy <= radius; ++dy) {
    while (dx * dx + dy * dy > radius * radius) --dx;
    half_widths_.push_back(dx);
  }
}

std::size_t DiskMinima::complete(bool ended) const {
  return ended ? given_ : given_ - std::min(given_, disk_.radius());
}

void DiskMinima::drop(std::size_t number) {
  minima_.erase(minima_.begin(), minima_.begin() + static_cast<std::ptrdiff_t>((number - dropped_) * columns_));
  dropped_ = number;
}

void DiskMinima::add(const double* values, std::size_t rows) {
  minima_.resize((given_ + rows + disk_.radius() - dropped_) * columns_, kNoCell);
  parallel_for_blocks(columns_, kColumnsAtOnce,
                      [&](std::size_t first, std::size_t n, unsigned) { add_part(values, rows, first, first + n); });
  given_ += rows;
}

/// Takes the columns `first` to `end` - 1 of new rows. Minima over 2w + 1 successive cells of a row come from minima
/// over 2w - 1 cells. The rows of the disk with the half width w take the minima over 2w + 1 cells.
void DiskMinima::add_part(const double* values, std::size_t rows, std::size_t first, std::size_t end) {
  const std::size_t radius = disk_.radius(), width = end - first;
  std::vector<double> minima(width + 2 * radius);
  for (std::size_t row = 0; row < rows; ++row) {
    std::ranges::fill(minima, kNoCell);
    const std::size_t from = first - std::min(first, radius), to = std::min(columns_, end + radius);
    std::copy(values + row * columns_ + from, values + row * columns_ + to,
              minima.begin() + static_cast<std::ptrdiff_t>(from + radius - first));
    if (std::ranges::all_of(minima, [](double value) { return value == kNoCell; })) continue;
    // minima[i] is the minimum around column first - radius + w + i.
    double* m = minima.data();
    for (std::size_t w = 0; w <= radius; ++w) {
      if (w > 0)
        for (std::size_t i = 0; i < width + 2 * (radius - w); ++i) m[i] = std::min(std::min(m[i], m[i + 1]), m[i + 2]);
      spread(m + (radius - w), given_ + row, w, first, end);
    }
  }
}

/// Includes the minima `values`, over pieces of `row`, in each row of the results whose disk has the half width
/// `half_width` at `row`.
void DiskMinima::spread(const double* values, std::size_t row, std::size_t half_width, std::size_t first,
                        std::size_t end) {
  const auto take = [&](std::size_t to) {
    double* minima = this->row(to);
    for (std::size_t c = first; c < end; ++c) minima[c] = std::min(minima[c], values[c - first]);
  };
  for (std::size_t dy = 0; dy <= disk_.radius(); ++dy) {
    if (disk_.half_width(dy) != half_width) continue;
    take(row + dy);
    if (dy > 0 && row >= dy) take(row - dy);
  }
}

OpenedRows::OpenedRows(std::unique_ptr<RowStream> from, std::size_t radius, double threshold, Opens opens)
    : RowStream(from->columns()),
      from_(std::move(from)),
      threshold_(threshold),
      upside_down_(opens == Opens::pit_marks),
      eroded_(radius, columns()),
      dilated_(radius, columns()) {
  held_.values.reserve(most_held(radius) * columns());
  held_.marks.reserve(most_held(radius) * columns());
}

/// Returns the bytes of memory per column. Includes the rows that next() returns at once when the source has ended: up
/// to 2 * radius rows, which waited for later rows.
std::size_t OpenedRows::column_bytes(std::size_t radius) {
  constexpr std::size_t kCell = sizeof(double) + 1;
  return 2 * DiskMinima::column_bytes(radius) + most_held(radius) * kCell +
         (radius + kRowsAtOnce) * (sizeof(double) + 2 * kCell);
}

double OpenedRows::turned(double value) const { return upside_down_ && value != kNoCell ? -value : value; }

bool OpenedRows::next(CellRows& out) {
  out.rows = 0;
  while (out.rows == 0) {
    if (!ended_) take_rows();
    dilate();
    give(dilated_.complete(ended_) - given_, out);
    if (ended_) break;
  }
  return out.rows > 0;
}

void OpenedRows::take_rows() {
  ended_ = !from_->next(block_);
  if (ended_) return;
  turned_.resize(block_.values.size());
  std::ranges::transform(block_.values, turned_.begin(), [this](double value) { return turned(value); });
  eroded_.add(turned_.data(), block_.rows);
  held_.values.insert(held_.values.end(), block_.values.begin(), block_.values.end());
  held_.marks.insert(held_.marks.end(), block_.marks.begin(), block_.marks.end());
  held_.rows += block_.rows;
}

/// The maximum of the eroded values is the negated minimum of the negated values.
void OpenedRows::dilate() {
  const std::size_t done = given_ + held_.rows, complete = eroded_.complete(ended_), first = dilated_.given();
  if (complete == first) return;
  const double* values = held_.values.data() + (held_.rows - (done - first)) * columns();
  const double* eroded = eroded_.row(first);
  turned_.resize((complete - first) * columns());
  for (std::size_t i = 0; i < turned_.size(); ++i) turned_[i] = values[i] == kNoCell ? kNoCell : -eroded[i];
  dilated_.add(turned_.data(), complete - first);
  eroded_.drop(complete);
}

void OpenedRows::give(std::size_t rows, CellRows& out) {
  const auto cells = static_cast<std::ptrdiff_t>(rows * columns());
  out.rows = rows;
  out.values.assign(held_.values.begin(), held_.values.begin() + cells);
  out.marks.assign(held_.marks.begin(), held_.marks.begin() + cells);
  const double* opened = rows == 0 ? nullptr : dilated_.row(given_);
  for (std::size_t i = 0; i < out.values.size(); ++i) {
    if (out.values[i] == kNoCell) continue;
    if (turned(out.values[i]) + opened[i] > threshold_) out.marks[i] = 1;
    if (!upside_down_) out.values[i] = -opened[i];
  }
  given_ += rows;
  dilated_.drop(given_);
  held_.values.erase(held_.values.begin(), held_.values.begin() + cells);
  held_.marks.erase(held_.marks.begin(), held_.marks.begin() + cells);
  held_.rows -= rows;
}

}  // namespace pointsweep
