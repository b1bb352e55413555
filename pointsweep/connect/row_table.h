// SPDX-License-Identifier: MIT
/// A table of values by the row of a point, from which rows can be erased.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "pointsweep/math/mix.h"

namespace pointsweep {

/// A hash table from rows to values, with linear probing. A row is less than 2^64 - 1.
template <class Value>
class RowTable {
 public:
  /// Returns the value of a row, and true if add() has inserted the row with a default-constructed value. Pointers to
  /// values become invalid with the next add() or erase().
  std::pair<Value*, bool> add(std::uint64_t row) {
    if (2 * (size_ + 1) > entries_.size()) grow();
    std::size_t at = home(row);
    for (; entries_[at].row != kNone; at = (at + 1) & mask_)
      if (entries_[at].row == row) return {&entries_[at].value, false};
    entries_[at] = {row, Value()};
    ++size_;
    return {&entries_[at].value, true};
  }
  /// Returns the value of a row; null if the table does not hold the row.
  Value* find(std::uint64_t row) { return const_cast<Value*>(std::as_const(*this).find(row)); }
  const Value* find(std::uint64_t row) const {
    if (size_ == 0) return nullptr;
    for (std::size_t at = home(row); entries_[at].row != kNone; at = (at + 1) & mask_)
      if (entries_[at].row == row) return &entries_[at].value;
    return nullptr;
  }
  bool erase(std::uint64_t row) {
    if (size_ == 0) return false;
    std::size_t at = home(row);
    for (; entries_[at].row != row; at = (at + 1) & mask_)
      if (entries_[at].row == kNone) return false;
    close_gap(at);
    --size_;
    return true;
  }
  std::size_t size() const { return size_; }
  /// Removes all rows, and keeps the memory.
  void clear() {
    for (Entry& entry : entries_) entry.row = kNone;
    size_ = 0;
  }
  template <class Use>
  void for_each(Use use) {
    for (Entry& entry : entries_)
      if (entry.row != kNone) use(entry.row, entry.value);
  }

 private:
  static constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();
  struct Entry {
    std::uint64_t row = kNone;
    Value value = {};
  };
  std::size_t home(std::uint64_t row) const { return mix(row) & mask_; }
  /// Fills the free entry at `gap` with later entries of its probe sequence, so that find() still reaches them.
  void close_gap(std::size_t gap) {
    for (std::size_t at = (gap + 1) & mask_; entries_[at].row != kNone; at = (at + 1) & mask_) {
      const std::size_t from_home = (at - home(entries_[at].row)) & mask_;
      if (from_home < ((at - gap) & mask_)) continue;
      entries_[gap] = entries_[at];
      gap = at;
    }
    entries_[gap].row = kNone;
  }
  void grow() {
    std::vector<Entry> before(entries_.empty() ? 64 : 2 * entries_.size());
    before.swap(entries_);
    mask_ = entries_.size() - 1;
    for (const Entry& entry : before) {
      if (entry.row == kNone) continue;
      std::size_t at = home(entry.row);
      while (entries_[at].row != kNone) at = (at + 1) & mask_;
      entries_[at] = entry;
    }
  }

  std::vector<Entry> entries_;
  std::size_t mask_ = 0, size_ = 0;
};

}  // namespace pointsweep
