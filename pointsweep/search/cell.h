// SPDX-License-Identifier: MIT
/// A cell: a compact group of about a thousand points of one slab, cut into leaves of 16 points with tight boxes;
/// subsets of its points; and the directory of the cells that a search may visit.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/neighborhood.h"

namespace pointsweep {

inline constexpr std::uint32_t kLeafCapacity = 16;

/// The points of a cell as a structure of arrays, in one allocation that the cell owns. Leaf l holds the points [16 l,
/// min(16 l + 16, size)). Boxes of leaves are in single precision relative to `origin`, rounded outward, so that no box
/// is too small.
class Cell {
 public:
  Cell() = default;
  /// Allocates memory for `size` points. The caller fills x, y, z and row, and then calls seal().
  explicit Cell(std::uint32_t size);
  /// Pads the arrays, and computes box, origin, leaf boxes and lowest rows.
  void seal();

  std::uint32_t size() const { return size_; }
  std::uint32_t leaf_count() const { return (size_ + kLeafCapacity - 1) / kLeafCapacity; }
  std::uint32_t leaf_size(std::uint32_t leaf) const {
    return leaf + 1 < leaf_count() ? kLeafCapacity : size_ - leaf * kLeafCapacity;
  }
  Vec3 position(std::uint32_t i) const { return {x[i], y[i], z[i]}; }
  std::size_t memory_bytes() const { return bytes_; }

  Box box;
  Vec3 origin;
  /// Value of `lowest_row` and `leaf_lowest_row` for points that are not all at one place.
  static constexpr std::uint64_t kSeveralPlaces = ~std::uint64_t{0};
  /// Lowest row of the points if all of them are at one place; kSeveralPlaces otherwise.
  std::uint64_t lowest_row = kSeveralPlaces;
  double* x = nullptr;  ///< x, y, z and row are padded to whole leaves with copies of the last point
  double* y = nullptr;
  double* z = nullptr;
  std::uint64_t* row = nullptr;
  /// Sides of the leaf boxes: lo x, y, z, hi x, y, z. Each array is padded to a multiple of 16 with boxes infinitely
  /// far away.
  float* leaf_box[6] = {};
  /// For each leaf, the lowest row of its points if all of them are at one place; kSeveralPlaces otherwise.
  std::uint64_t* leaf_lowest_row = nullptr;

 private:
  Box bounds_of_leaf(std::uint32_t leaf) const;
  void set_leaf(std::uint32_t leaf, const Box& bounds);

  struct Free {
    void operator()(std::byte* p) const;
  };
  std::unique_ptr<std::byte[], Free> storage_;
  std::uint32_t size_ = 0;
  std::size_t bytes_ = 0;
};

/// Returns a float that is not above v, and at most two steps below it.
inline float round_down(double v) {
  const float f = std::min(static_cast<float>(v), std::numeric_limits<float>::max());
  return static_cast<double>(f) > v ? f - (std::abs(f) * 0x1p-23f + std::numeric_limits<float>::denorm_min()) : f;
}
/// Returns a float that is not below v, and at most two steps above it.
inline float round_up(double v) { return -round_down(-v); }

/// Ascending indices of points in a cell: a run of successive indices, or chosen indices in an array that the caller
/// owns.
class CellSubset {
 public:
  CellSubset(const Cell& cell) : CellSubset(0, cell.size()) {}  ///< all points of the cell
  CellSubset(std::uint32_t first, std::uint32_t end) : first_(first), size_(end - first) {}
  CellSubset(const std::vector<std::uint32_t>& chosen) : CellSubset(std::span(chosen)) {}
  CellSubset(std::span<const std::uint32_t> chosen)
      : chosen_(chosen.data()), size_(static_cast<std::uint32_t>(chosen.size())) {}

  std::uint32_t size() const { return size_; }
  std::uint32_t operator[](std::uint32_t n) const { return chosen_ == nullptr ? first_ + n : chosen_[n]; }
  bool is_run() const { return chosen_ == nullptr; }

  /// Returns `size` of the points, from number `n` on.
  CellSubset part(std::uint32_t n, std::uint32_t size) const {
    return chosen_ == nullptr ? CellSubset(first_ + n, first_ + n + size) : CellSubset(std::span(chosen_ + n, size));
  }
  CellSubset from(std::uint32_t n) const { return part(n, size_ - n); }
  /// Returns how many of the points have an index below `index`.
  std::uint32_t count_below(std::uint32_t index) const {
    if (chosen_ == nullptr) return std::clamp(index, first_, first_ + size_) - first_;
    return static_cast<std::uint32_t>(std::lower_bound(chosen_, chosen_ + size_, index) - chosen_);
  }

 private:
  const std::uint32_t* chosen_ = nullptr;  ///< indices of chosen points; null for a run
  std::uint32_t first_ = 0;                ///< first point of a run
  std::uint32_t size_;
};

/// The cells that a search may visit, each under a slot, which is the number of a place for a cell in memory. A
/// NeighborRef (neighborhood.h) names a point by the slot of its cell and its index in the cell.
///
/// The directory is a flat table. The window (the cells in memory) has some hundreds of cells, so a linear scan for
/// each searched cell costs a few nanoseconds per point, less than a tree would. Reading is thread-safe, changing is
/// not.
class CellDirectory {
 public:
  struct Near {
    double distance2;  ///< squared distance between the box of the query and the box of the cell
    std::uint32_t slot;
    friend bool operator<(const Near& a, const Near& b) {
      return a.distance2 != b.distance2 ? a.distance2 < b.distance2 : a.slot < b.slot;
    }
  };

  /// Adds a cell under a slot that no other cell has. The directory keeps the pointer: the caller owns the cell, which
  /// must not move before remove().
  void add(std::uint32_t slot, const Cell* cell);
  void remove(std::uint32_t slot);
  const Cell& cell(std::uint32_t slot) const { return *cells_[slot]; }
  bool contains(std::uint32_t slot) const { return slot < cells_.size() && cells_[slot] != nullptr; }
  std::size_t size() const { return slots_.size(); }
  const std::vector<std::uint32_t>& slots() const { return slots_; }

  /// Finds all cells whose box is within sqrt(reach2) of `box`, nearest first (equal distances by slot).
  void find(const Box& box, double reach2, std::vector<Near>& out) const;

 private:
  std::vector<const Cell*> cells_;       ///< cell in each slot; null in a free slot
  std::vector<std::uint32_t> position_;  ///< for each slot, index of its cell in `slots_` and `side_`
  std::vector<std::uint32_t> slots_;
  std::vector<double> side_[6];  ///< sides of the boxes of the cells: lo x, y, z, hi x, y, z
};

}  // namespace pointsweep
