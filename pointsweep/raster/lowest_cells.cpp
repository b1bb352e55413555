// SPDX-License-Identifier: MIT
#include "pointsweep/raster/lowest_cells.h"

#include <algorithm>
#include <utility>

namespace pointsweep {
namespace {

constexpr std::size_t kCellsAtOnce = 4096;

}  // namespace

LowestCells::LowestCells(AxisRule rule, std::unique_ptr<Scratch> scratch)
    : columns_(rule), rows_(rule), scratch_(std::move(scratch)) {}

void LowestCells::add(double row, double column, double z) {
  if (any_ && row == row_ && column == cell_.column) {
    cell_.z = std::min(cell_.z, z);
    return;
  }
  if (any_) put();
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

void LowestCells::flush() {
  scratch_->append(std::as_bytes(std::span(buffer_)));
  buffer_.clear();
}

void LowestCells::finish() {
  if (any_) put();
  flush();
  columns_.finish();
}

void LowestCells::read(std::uint64_t first, std::vector<LowestCell>& out) const {
  out.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kCellsAtOnce, count_ - first)));
  scratch_->read(first * sizeof(LowestCell), std::as_writable_bytes(std::span(out)));
}

bool LowestRows::next(CellRows& out) {
  const auto rows = static_cast<std::size_t>(std::min<std::uint64_t>(kRowsAtOnce, cells_.rows() - row_));
  out.rows = rows;
  out.values.assign(rows * columns(), kNoCell);
  out.marks.assign(rows * columns(), 0);
  while (true) {
    if (at_ == buffer_.size()) {
      if (read_ == cells_.count()) break;
      cells_.read(read_, buffer_);
      read_ += buffer_.size();
      at_ = 0;
    }
    const LowestCell& cell = buffer_[at_];
    if (cell.row >= row_ + rows) break;
    out.values[static_cast<std::size_t>(cell.row - row_) * columns() + cells_.columns().place_of(cell.column)] = cell.z;
    ++at_;
  }
  row_ += rows;
  return rows > 0;
}

}  // namespace pointsweep
