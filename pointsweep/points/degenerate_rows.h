// SPDX-License-Identifier: MIT
/// The rows of points whose data define no result, collected over any number of batches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pointsweep {

/// The number of rows that were added, and the lowest of these rows. Both depend neither on the order in which rows are
/// added, nor on the division of rows among objects that are later added to each other. Every row may be added once.
class DegenerateRows {
 public:
  static constexpr std::uint64_t kMostListed = 1000;

  DegenerateRows() = default;
  /// Restores a set of `count` rows. `lowest`: its lowest rows, at most kMostListed.
  DegenerateRows(std::uint64_t count, std::vector<std::uint64_t> lowest);

  void add(std::uint64_t row);
  void add(const DegenerateRows& others);

  std::uint64_t count() const { return count_; }
  /// Returns the lowest rows, ascending; at most kMostListed.
  std::vector<std::uint64_t> lowest() const;

 private:
  void keep(std::uint64_t row);

  std::uint64_t count_ = 0;
  std::vector<std::uint64_t> heap_;  ///< heap of the lowest rows, with the greatest of them in front
};

/// Adds the rows of each stage in `from` to the rows of this stage in `to`, which grows to the length of `from`.
void add_rows(std::vector<DegenerateRows>& to, const std::vector<DegenerateRows>& from);

}  // namespace pointsweep
