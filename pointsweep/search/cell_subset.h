// SPDX-License-Identifier: MIT
/// Some points of one cell.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/search/cell.h"

namespace pointsweep {

/// Indices of points in a cell, ascending: a run of them, or chosen ones, which the caller keeps.
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
  const std::uint32_t* chosen_ = nullptr;  ///< null: a run
  std::uint32_t first_ = 0;                ///< first point of a run
  std::uint32_t size_;
};

}  // namespace pointsweep
