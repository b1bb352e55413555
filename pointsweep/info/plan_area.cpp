// SPDX-License-Identifier: MIT
#include "pointsweep/info/plan_area.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace pointsweep {
namespace {

constexpr double kSmallestSide = 0x1p-40, kMostCells = 0x1p62;  // kMostCells: number of cells on either side of 0

std::size_t place_of(std::int64_t x, std::int64_t y, std::size_t size) {
  std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15u;
  h = (h ^ (h >> 32)) + static_cast<std::uint64_t>(y);
  h *= 0xd6e8feb86659fd93u;
  return static_cast<std::size_t>(h ^ (h >> 32)) & (size - 1);
}

/// Returns `index` / 2 rounded down, also for negative numbers.
std::int64_t halved(std::int64_t index) { return index >> 1; }

}  // namespace

PlanArea::PlanArea(std::uint64_t points)
    : limit_(std::clamp<std::uint64_t>(points / 16, 16, 65536)),
      lo_x_(std::numeric_limits<double>::infinity()),
      hi_x_(-lo_x_),
      lo_y_(lo_x_),
      hi_y_(-lo_x_),
      side_(kSmallestSide),
      table_(std::bit_ceil(2 * limit_)) {}

PlanArea::Cell PlanArea::cell_of(double x, double y) const {
  return {static_cast<std::int64_t>(std::floor(x / side_)), static_cast<std::int64_t>(std::floor(y / side_)), true};
}

void PlanArea::add(double x, double y) {
  lo_x_ = std::min(lo_x_, x), hi_x_ = std::max(hi_x_, x);
  lo_y_ = std::min(lo_y_, y), hi_y_ = std::max(hi_y_, y);
  while (std::max(std::abs(x), std::abs(y)) / side_ >= kMostCells) coarsen();
  const Cell cell = cell_of(x, y);
  if (last_.taken && cell.x == last_.x && cell.y == last_.y) return;
  last_ = cell;
  if (insert(cell)) ++count_;
  while (count_ > limit_) has_area_ = true, coarsen();
}

double PlanArea::cells_of_bounds() const {
  const auto cells = [&](double lo, double hi) { return std::floor(hi / side_) - std::floor(lo / side_) + 1; };
  return cells(lo_x_, hi_x_) * cells(lo_y_, hi_y_);
}

void PlanArea::settle() {
  while (has_area_ && cells_of_bounds() > static_cast<double>(limit_)) coarsen();
}

double PlanArea::area() const { return has_area_ ? static_cast<double>(count_) * side_ * side_ : 0; }

bool PlanArea::insert(Cell cell) {
  std::size_t i = place_of(cell.x, cell.y, table_.size());
  for (; table_[i].taken; i = (i + 1) & (table_.size() - 1))
    if (table_[i].x == cell.x && table_[i].y == cell.y) return false;
  table_[i] = cell;
  return true;
}

void PlanArea::coarsen() {
  const std::vector<Cell> finer = std::exchange(table_, std::vector<Cell>(table_.size()));
  side_ *= 2;
  count_ = 0;
  last_ = {};
  for (const Cell& cell : finer)
    if (cell.taken && insert({halved(cell.x), halved(cell.y), true})) ++count_;
}

}  // namespace pointsweep
