// SPDX-License-Identifier: MIT
/// Exact quantiles in bounded memory, of values that are read several times.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/info.h"

namespace pointsweep {

/// Throws Error for points that differ from one reading to the next.
[[noreturn]] void fail_of_changed_points();

/// Finds the keys at the quantile_rank() of each percentage of PointStatistics::kPercent. It keeps intervals of keys,
/// each of which holds some of the ranks. A reading counts the keys in equal parts of each interval, which then shrinks
/// to the parts that contain its ranks. For an interval with few keys, the keys themselves are collected instead.
class RankSearch {
 public:
  static constexpr std::size_t kRanks = PointStatistics::kPercent.size();

  /// Begins a search among `count` keys from `least` to `most`. A search among no keys finds none.
  RankSearch(std::uint64_t count, std::uint64_t least, std::uint64_t most);

  /// Returns the number of intervals that the next reading divides.
  std::size_t open() const { return intervals_.size(); }
  /// Begins a reading. Assigns each interval at most `share` numbers in the array `room` of add() and end(), from index
  /// `next` on, and advances `next` past them. `share`: 2 to 2^63.
  void begin(std::uint64_t share, std::uint64_t& next);
  /// Takes one of the keys. `room`: the numbers in which all intervals count or store keys; 0 when the reading begins.
  void add(std::uint64_t key, std::span<std::uint64_t> room);
  /// Ends a reading. Throws Error if its keys differ from the keys of earlier readings.
  void end(std::span<std::uint64_t> room);

  /// Returns the keys found. No interval may be open.
  const std::array<std::uint64_t, kRanks>& keys() const { return found_; }

 private:
  /// The keys from `least` to `most`, whose number is `count`, and the ranks [first, last) to be found among them.
  struct Interval {
    std::uint64_t least, most, count;
    std::uint8_t first, last;
    std::uint8_t shift = 0;   ///< a part has 2^shift keys
    bool takes_keys = false;  ///< true if the room stores the keys themselves
    std::uint64_t at = 0;     ///< index in the room of the first number of the interval
    std::uint64_t taken = 0;
  };
  void divide(const Interval& interval, std::span<std::uint64_t> room, std::vector<Interval>& parts);

  std::vector<Interval> intervals_;            ///< ascending
  std::array<std::uint64_t, kRanks> ranks_{};  ///< for each key to be found, its rank in its interval
  std::array<std::uint64_t, kRanks> found_{};
};

}  // namespace pointsweep
