// SPDX-License-Identifier: MIT
/// Statistics of the values of one attribute: number, range, mean, standard deviation, bins of a histogram, and exact
/// quantiles. The results do not depend on the order of the values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pointsweep/info.h"
#include "pointsweep/info/value_keys.h"
#include "pointsweep/math/exact_sum.h"

namespace pointsweep {

/// Exact sums of values and of their squares: integers of 128 bits for whole numbers of up to 32 bits, else two sums of
/// 1.1 kB each.
class ValueMoments {
 public:
  /// `sums`: false if only number and range are needed; mean() and deviation() must not be called then.
  ValueMoments(const ValueKeys& keys, bool sums);
  void add(const ValueKeys& keys, std::uint64_t key);

  std::uint64_t count() const { return count_; }          ///< number of finite values
  std::uint64_t nonfinite() const { return nonfinite_; }  ///< NaN and infinite values
  /// Returns the key of the least value; 2^64 - 1 if count() is 0.
  std::uint64_t least() const { return least_; }
  /// Returns the key of the greatest value; 0 if count() is 0.
  std::uint64_t most() const { return most_; }
  /// Returns the rounded exact sum divided by count(); none without values, or if the sum is beyond float64.
  std::optional<double> mean() const;
  /// Returns the standard deviation, with the divisor count() - 1; none for fewer than two values, or if the sum of
  /// their squares is beyond float64.
  std::optional<double> deviation() const;

  /// Returns the memory in bytes that a ValueMoments takes.
  static std::uint64_t bytes(const ValueKeys& keys, bool sums);

 private:
  struct Sums {
    ExactSum values, squares;
  };
  /// Returns `exact_`; without it, `sum_` and `squares_` as exact sums.
  Sums sums() const;

  std::uint64_t count_ = 0, nonfinite_ = 0;
  std::uint64_t least_ = std::numeric_limits<std::uint64_t>::max(), most_ = 0;
  Int128 sum_ = 0, squares_ = 0;  ///< sums for whole numbers of up to 32 bits
  std::unique_ptr<Sums> exact_;   ///< sums for all other values; null if is_small(), or if not requested
};

/// Bins of equal width over a range of values. A bin includes its lower edge and excludes its upper edge. Edges are
/// multiples of the width. The width is the least product of 1, 2 or 5 and a power of ten that gives at most the
/// requested number of bins, is at least 2^-50 of the greatest magnitude in the range, and is at least 1 for whole
/// numbers and for a range of one value.
class HistogramBins {
 public:
  /// `least` and `most`: keys of the range. `wanted`: largest number of bins, at least 2, because a 0 inside of the
  /// range is an edge whatever the width.
  HistogramBins(const ValueKeys& keys, std::uint64_t least, std::uint64_t most, std::uint64_t wanted);

  std::size_t size() const { return static_cast<std::size_t>(last_ - first_) + 1; }
  /// Returns size() + 1 edges, ascending. An edge beyond the range of float64 becomes the finite float64 number of its
  /// sign with the greatest magnitude.
  std::vector<double> edges() const;
  /// Returns the index, below size(), of the bin that holds the value.
  std::size_t bin_of(const ValueKeys& keys, std::uint64_t key) const;

 private:
  void set_width(int digit, int exponent);
  /// Returns the greatest integer m for which m times the width is not above the value.
  std::int64_t multiple_below(const ValueKeys& keys, std::uint64_t key) const;
  double edge(std::int64_t multiple) const;

  int digit_ = 1, exponent_ = 0;       ///< the width is digit_ * 10^exponent_
  double power_ = 1;                   ///< 10^|exponent_|
  Int128 whole_width_ = 1;             ///< width for whole numbers
  std::int64_t first_ = 0, last_ = 0;  ///< lower edges of the first and the last bin, as multiples of the width
};

/// Throws Error with the sentence that the points have changed between two readings.
[[noreturn]] void fail_of_changed_points();

/// Finds the keys at the quantile_rank() of each percentage of PointStatistics::kPercent. The search keeps intervals of
/// keys, each of which holds some of the ranks. A reading counts the keys in equal parts of each interval; then the
/// parts that contain ranks replace the interval. If an interval has no more keys than its share of the counters, the
/// reading collects the keys themselves. When no interval is left, the search is complete.
class RankSearch {
 public:
  static constexpr std::size_t kRanks = PointStatistics::kPercent.size();

  /// Begins a search among `count` keys from `least` to `most`. If `count` is 0, the search is complete and keys() are
  /// 0.
  RankSearch(std::uint64_t count, std::uint64_t least, std::uint64_t most);

  /// Returns the number of intervals that the next reading divides.
  std::size_t open() const { return intervals_.size(); }
  /// Begins a reading. Assigns each interval at most `share` (2 to 2^63) counters in the array `room` of add() and
  /// end(), from index `next` on, and advances `next` past them.
  void begin(std::uint64_t share, std::uint64_t& next);
  /// Takes the key of one value. `room`: counters in which all intervals count or store keys; all 0 when the reading
  /// begins. Throws Error if an interval gets more keys than an earlier reading counted in it.
  void add(std::uint64_t key, std::span<std::uint64_t> room);
  /// Ends a reading. Throws Error if an interval has got another number of keys than an earlier reading counted in it.
  void end(std::span<std::uint64_t> room);

  /// Returns the keys found. No interval may be open.
  const std::array<std::uint64_t, kRanks>& keys() const { return found_; }

 private:
  /// The keys from `least` to `most`: `count` values have them. `first` and `last`: range in `ranks_` of the ranks to
  /// be found among these values.
  struct Interval {
    std::uint64_t least, most, count;
    std::uint8_t first, last;
    std::uint8_t shift = 0;   ///< a part spans 2^shift keys; the last may span fewer
    bool takes_keys = false;  ///< true if `room` stores the keys themselves
    std::uint64_t at = 0;     ///< index in `room` of the first counter of the interval
    std::uint64_t taken = 0;
  };
  void divide(const Interval& interval, std::span<std::uint64_t> room, std::vector<Interval>& parts);

  std::vector<Interval> intervals_;            ///< ascending
  std::array<std::uint64_t, kRanks> ranks_{};  ///< for each key to be found, its rank, from 0, in its interval
  std::array<std::uint64_t, kRanks> found_{};
};

}  // namespace pointsweep
