// SPDX-License-Identifier: MIT
#include "pointsweep/search/cell.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdlib>
#include <new>

namespace pointsweep {
namespace {

std::size_t padded(std::size_t n) { return (n + 15) / 16 * 16; }
constexpr float kFar = std::numeric_limits<float>::max();

}  // namespace

void Cell::Free::operator()(std::byte* p) const { std::free(p); }

Cell::Cell(std::uint32_t size) : size_(size) {
  const std::size_t points = padded(size), leaves = padded(leaf_count());
  bytes_ = points * (3 * sizeof(double) + sizeof(std::uint64_t)) + leaves * (6 * sizeof(float) + sizeof(std::uint64_t));
  std::byte* p = static_cast<std::byte*>(std::aligned_alloc(64, (bytes_ + 63) / 64 * 64));
  if (p == nullptr) throw std::bad_alloc();
  storage_.reset(p);
  const auto take = [&p](auto*& array, std::size_t count) {
    array = reinterpret_cast<std::remove_reference_t<decltype(array)>>(p);
    p += count * sizeof(*array);
  };
  take(x, points);
  take(y, points);
  take(z, points);
  take(row, points);
  for (float*& side : leaf_box) take(side, leaves);
  take(leaf_lowest_row, leaves);
}

void Cell::seal() {
  if (size_ == 0) return;
  for (std::size_t i = size_; i < padded(size_); ++i) {
    x[i] = x[size_ - 1], y[i] = y[size_ - 1], z[i] = z[size_ - 1], row[i] = row[size_ - 1];
  }
  std::array<Box, kCellCapacity / kLeafCapacity> leaves;  // boxes of whole leaves: padding repeats a point
  box = Box{};
  for (std::uint32_t l = 0; l < leaf_count(); ++l) {
    leaves[l] = bounds_of_leaf(l);
    box.include(leaves[l]);
  }
  origin = box.center();
  for (std::uint32_t l = 0; l < leaf_count(); ++l) set_leaf(l, leaves[l]);
  lowest_row = box.lo == box.hi ? *std::min_element(row, row + size_) : kSeveralPlaces;
  for (std::size_t l = leaf_count(); l < padded(leaf_count()); ++l) {
    for (int side = 0; side < 3; ++side) leaf_box[side][l] = kFar, leaf_box[side + 3][l] = -kFar;
  }
}

Box Cell::bounds_of_leaf(std::uint32_t leaf) const {
  Box bounds;
  for (const int axis : {0, 1, 2}) {
    const double* c = (axis == 0 ? x : axis == 1 ? y : z) + leaf * kLeafCapacity;
    // Four independent minima and maxima, so that the processor need not wait for the previous comparison.
    double lo[4] = {c[0], c[1], c[2], c[3]}, hi[4] = {c[0], c[1], c[2], c[3]};
    for (std::size_t i = 4; i < kLeafCapacity; i += 4) {
      for (std::size_t j = 0; j < 4; ++j) {
        lo[j] = c[i + j] < lo[j] ? c[i + j] : lo[j];
        hi[j] = hi[j] < c[i + j] ? c[i + j] : hi[j];
      }
    }
    bounds.lo[axis] = std::min(std::min(lo[0], lo[1]), std::min(lo[2], lo[3]));
    bounds.hi[axis] = std::max(std::max(hi[0], hi[1]), std::max(hi[2], hi[3]));
  }
  return bounds;
}

void Cell::set_leaf(std::uint32_t leaf, const Box& bounds) {
  // The subtraction of the origin rounds. A slack far below single precision ensures that boxes are not too small.
  const Vec3 slack = 0x1p-50 * box.extent();
  for (const int axis : {0, 1, 2}) {
    leaf_box[axis][leaf] = round_down(bounds.lo[axis] - origin[axis] - slack[axis]);
    leaf_box[axis + 3][leaf] = round_up(bounds.hi[axis] - origin[axis] + slack[axis]);
  }
  const std::uint64_t* rows = row + leaf * kLeafCapacity;
  leaf_lowest_row[leaf] = bounds.lo == bounds.hi ? *std::min_element(rows, rows + kLeafCapacity) : kSeveralPlaces;
}

void CellDirectory::add(std::uint32_t slot, const Cell* cell) {
  if (slot >= cells_.size()) {
    cells_.resize(slot + 1, nullptr);
    position_.resize(slot + 1, 0);
  }
  assert(cells_[slot] == nullptr);
  cells_[slot] = cell;
  position_[slot] = static_cast<std::uint32_t>(slots_.size());
  slots_.push_back(slot);
  for (int a = 0; a < 3; ++a) {
    side_[a].push_back(cell->box.lo[a]);
    side_[a + 3].push_back(cell->box.hi[a]);
  }
}

void CellDirectory::remove(std::uint32_t slot) {
  const std::uint32_t at = position_[slot];
  for (auto& side : side_) {
    side[at] = side.back();
    side.pop_back();
  }
  slots_[at] = slots_.back();
  position_[slots_[at]] = at;
  slots_.pop_back();
  cells_[slot] = nullptr;
}

void CellDirectory::find(const Box& box, double reach2, std::vector<Near>& out) const {
  out.clear();
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    const double dx = std::max(std::max(side_[0][i] - box.hi.x, box.lo.x - side_[3][i]), 0.0);
    const double dy = std::max(std::max(side_[1][i] - box.hi.y, box.lo.y - side_[4][i]), 0.0);
    const double dz = std::max(std::max(side_[2][i] - box.hi.z, box.lo.z - side_[5][i]), 0.0);
    const double d2 = (dx * dx + dy * dy) + dz * dz;
    if (d2 <= reach2) out.push_back({d2, slots_[i]});
  }
  std::sort(out.begin(), out.end());
}

}  // namespace pointsweep
