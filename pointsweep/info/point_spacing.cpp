// SPDX-License-Identifier: MIT
#include "pointsweep/info/point_spacing.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace pointsweep {
namespace {

constexpr double kSmallestSide = 0x1p-40, kMostCells = 0x1p62;  // kMostCells: limit for an index in magnitude

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

namespace {

constexpr std::uint32_t kLeaf = 8;
constexpr double kInf = std::numeric_limits<double>::infinity();

}  // namespace

NearestDistances::NearestDistances(std::vector<Sampled> sample)
    : sample_(std::move(sample)), nearest2_(sample_.size(), kInf) {
  if (!sample_.empty()) build(0, static_cast<std::uint32_t>(sample_.size()));
}

void NearestDistances::build(std::uint32_t begin, std::uint32_t end) {
  Node node{{}, kInf, begin, end, 0};
  for (std::uint32_t i = begin; i < end; ++i) node.box.include(sample_[i].position);
  const std::size_t index = nodes_.size();
  nodes_.push_back(node);
  if (end - begin <= kLeaf) return;
  const int axis = node.box.longest_axis();
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(sample_.begin() + begin, sample_.begin() + middle, sample_.begin() + end,
                   [axis](const Sampled& a, const Sampled& b) { return a.position[axis] < b.position[axis]; });
  build(begin, middle);
  nodes_[index].above = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end);
}

void NearestDistances::add(Vec3 position, std::uint64_t row) {
  if (!nodes_.empty()) visit(0, position, row);
}

void NearestDistances::visit(std::uint32_t index, Vec3 position, std::uint64_t row) {
  Node& node = nodes_[index];
  if (distance2(node.box, position) >= node.farthest2) return;
  if (node.above != 0) {
    visit(index + 1, position, row);
    visit(node.above, position, row);
    node.farthest2 = std::max(nodes_[index + 1].farthest2, nodes_[node.above].farthest2);
    return;
  }
  node.farthest2 = 0;
  for (std::uint32_t i = node.begin; i < node.end; ++i) {
    if (sample_[i].row != row) {
      const Vec3 d = sample_[i].position - position;
      nearest2_[i] = std::min(nearest2_[i], dot(d, d));
    }
    node.farthest2 = std::max(node.farthest2, nearest2_[i]);
  }
}

std::vector<double> NearestDistances::distances() const {
  std::vector<double> found;
  for (const double d2 : nearest2_)
    if (d2 < kInf) found.push_back(std::sqrt(d2));
  std::ranges::sort(found);
  return found;
}

}  // namespace pointsweep
