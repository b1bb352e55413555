// SPDX-License-Identifier: MIT
#include "pointsweep/raster/lowest_cells.h"

#include <algorithm>
#include <utility>

namespace pointsweep {
namespace {

constexpr std::size_t kCellsAtOnce = 4096;

}  // namespace

LowestCells::LowestCells(AxisRule rule, std::unique_ptr<Scratch> scratch)
    : rule_(rule), columns_(rule), rows_(rule), scratch_(std::move(scratch)) {}

void LowestCells::add(double row, double column, double z) {
  if (any_ && row == row_ && column == cell_.column) {
    cell_.z = std::min(cell_.z, z);
    return;
  }
  if (any_) put();
  if (any_ && rows_.begins_band(row)) end_band();
  any_ = true;
  row_ = row;
  cell_ = {rows_.place_of(row), column, z};
}

void LowestCells::put() {
  columns_.add(cell_.column);
  buffer_.push_back(cell_);
  ++count_;
  if (buffer_.size() == kCellsAtOnce) flush();
}

void LowestCells::end_band() {
  columns_.finish();
  most_columns_ = std::max(most_columns_, columns_.size());
  columns_ = CellAxis(rule_);
  bands_.push_back({bands_.empty() ? 0 : bands_.back().end, count_, rows_.rows()});
}

void LowestCells::flush() {
  scratch_->append(std::as_bytes(std::span(buffer_)));
  buffer_.clear();
}

void LowestCells::finish() {
  if (!any_) return;
  put();
  end_band();
  flush();
}

void LowestCells::read(std::uint64_t first, std::uint64_t end, std::vector<LowestCell>& out) const {
  out.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kCellsAtOnce, end - first)));
  scratch_->read(first * sizeof(LowestCell), std::as_writable_bytes(std::span(out)));
}

CellBand::CellBand(const LowestCells& cells, std::size_t number)
    : cells_(cells), band_(cells.bands_[number]), columns_(cells.rule_) {
  std::vector<LowestCell> some;
  for (std::uint64_t first = 0; first < count(); first += some.size()) {
    read(first, some);
    for (const LowestCell& cell : some) {
      columns_.add(cell.column);
      lowest_ = std::min(lowest_, cell.z), highest_ = std::max(highest_, cell.z);
    }
  }
  columns_.finish();
}

bool LowestRows::next(CellRows& out) {
  const auto rows = static_cast<std::size_t>(std::min<std::uint64_t>(kRowsAtOnce, band_.rows() - row_));
  out.rows = rows;
  out.values.assign(rows * columns(), kNoCell);
  out.marks.assign(rows * columns(), 0);
  while (true) {
    if (at_ == buffer_.size()) {
      if (read_ == band_.count()) break;
      band_.read(read_, buffer_);
      read_ += buffer_.size();
      at_ = 0;
    }
    const LowestCell& cell = buffer_[at_];
    if (cell.row >= row_ + rows) break;
    out.values[static_cast<std::size_t>(cell.row - row_) * columns() + band_.columns().place_of(cell.column)] = cell.z;
    ++at_;
  }
  row_ += rows;
  return rows > 0;
}

}  // namespace pointsweep
