// SPDX-License-Identifier: MIT
/// The points of a batch that have no result because their data define none.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pointsweep {

/// A set of indices of points, with one bit for each point. An empty set takes no heap memory.
class DegeneratePoints {
 public:
  /// Adds point `i` of the batch to the set. A point may be added again.
  void mark(std::size_t i) {
    if (i / kBits >= words_.size()) words_.resize(i / kBits + 1);
    words_[i / kBits] |= std::uint64_t{1} << i % kBits;
  }
  std::size_t count() const {
    std::size_t count = 0;
    for (const std::uint64_t word : words_) count += static_cast<std::size_t>(std::popcount(word));
    return count;
  }
  /// Calls `use(i)` for every marked point, in ascending order.
  template <class Use>
  void for_each(Use use) const {
    for (std::size_t w = 0; w < words_.size(); ++w)
      for (std::uint64_t word = words_[w]; word != 0; word &= word - 1)
        use(w * kBits + static_cast<std::size_t>(std::countr_zero(word)));
  }

 private:
  static constexpr std::size_t kBits = 64;
  std::vector<std::uint64_t> words_;
};

}  // namespace pointsweep
