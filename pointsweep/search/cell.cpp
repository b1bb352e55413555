// SPDX-License-Identifier: MIT
#include "pointsweep/search/cell.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>

namespace pointsweep {

namespace {
std::size_t padded(std::size_t n) { return (n + 15) / 16 * 16; }
constexpr float kFar = std::numeric_limits<float>::max();
}  // namespace

float round_down(double v) {
  const float f = static_cast<float>(v);
  return static_cast<double>(f) > v ? std::nextafterf(f, -std::numeric_limits<float>::infinity()) : f;
}

float round_up(double v) {
  const float f = static_cast<float>(v);
  return static_cast<double>(f) < v ? std::nextafterf(f, std::numeric_limits<float>::infinity()) : f;
}

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
  box = Box{};
  for (const int axis : {0, 1, 2}) {
    const double* c = axis == 0 ? x : axis == 1 ? y : z;
    const auto [lo, hi] = std::minmax_element(c, c + size_);
    box.lo[axis] = *lo, box.hi[axis] = *hi;
  }
  origin = box.center();
  // The subtraction of the origin rounds; a slack far below single precision keeps the boxes outward all the same.
  const Vec3 slack = 0x1p-50 * box.extent();
  const std::size_t leaves = leaf_count();
  for (std::size_t l = 0; l < leaves; ++l) {
    const std::size_t b = l * kLeafCapacity;  // the padding repeats a point, so whole leaves are safe
    bool one_place = true;
    for (const int axis : {0, 1, 2}) {
      const double* c = (axis == 0 ? x : axis == 1 ? y : z) + b;
      double lo = c[0], hi = c[0];
      for (std::size_t i = 1; i < kLeafCapacity; ++i) lo = std::min(lo, c[i]), hi = std::max(hi, c[i]);
      one_place = one_place && lo == hi;
      leaf_box[axis][l] = round_down(lo - origin[axis] - slack[axis]);
      leaf_box[axis + 3][l] = round_up(hi - origin[axis] + slack[axis]);
    }
    leaf_lowest_row[l] = one_place ? *std::min_element(row + b, row + b + kLeafCapacity) : kSeveralPlaces;
  }
  lowest_row = box.lo == box.hi ? *std::min_element(row, row + size_) : kSeveralPlaces;
  for (std::size_t l = leaves; l < padded(leaves); ++l) {
    for (int side = 0; side < 3; ++side) leaf_box[side][l] = kFar, leaf_box[side + 3][l] = -kFar;
  }
}

}  // namespace pointsweep
