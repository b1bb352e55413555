// SPDX-License-Identifier: MIT
/// Degenerate points, for which an operator has no result because their data define none (coincident points, for
/// example, define no normal): a set of the points of one batch, and the rows of the points of many batches.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pointsweep {

/// The indices of the degenerate points in one batch, as one bit for each point. An empty set takes no heap memory.
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

/// The number of rows that were added, and the lowest kMostListed of these rows. Both depend neither on the order in
/// which rows are added, nor on the division of rows among objects that are later added to each other. No row may be
/// added twice.
class DegenerateRows {
 public:
  static constexpr std::uint64_t kMostListed = 1000;

  DegenerateRows() = default;
  /// Restores the state with `count` added rows from a checkpoint. `lowest`: the result of lowest().
  DegenerateRows(std::uint64_t count, std::vector<std::uint64_t> lowest);

  void add(std::uint64_t row);
  void add(const DegenerateRows& others);

  std::uint64_t count() const { return count_; }
  /// Returns the lowest rows in ascending order, at most kMostListed.
  std::vector<std::uint64_t> lowest() const;

 private:
  void keep(std::uint64_t row);

  std::uint64_t count_ = 0;
  std::vector<std::uint64_t> heap_;  ///< max-heap of the lowest rows: the greatest of them is in front
};

/// Adds from[s], the rows of stage s, to to[s] for each stage of `from`. `to` grows if `from` has more stages.
void add_rows(std::vector<DegenerateRows>& to, const std::vector<DegenerateRows>& from);

}  // namespace pointsweep
