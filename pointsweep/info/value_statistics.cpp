// SPDX-License-Identifier: MIT
#include "pointsweep/info/value_statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/math/quantile_rank.h"

namespace pointsweep {
namespace {

/// Adds an integer to the sum without rounding, 32 bits at a time.
void add_whole(ExactSum& sum, Int128 value) {
  const double sign = value < 0 ? -1 : 1;
  auto rest = value < 0 ? -static_cast<UInt128>(value) : static_cast<UInt128>(value);
  for (double unit = sign; rest != 0; rest >>= 32, unit *= 0x1p32)
    sum.add(unit * static_cast<double>(static_cast<std::uint32_t>(rest)));
}

void add_square(ExactSum& sum, Int128 value) {
  const auto low = static_cast<double>(static_cast<std::uint32_t>(value));
  const double high = static_cast<double>(static_cast<std::int64_t>(value >> 32)) * 0x1p32;
  sum.add_product(high, high);
  sum.add_product(2 * high, low);
  sum.add_product(low, low);
}

std::optional<double> if_finite(double value) { return std::isfinite(value) ? std::optional(value) : std::nullopt; }

}  // namespace

ValueMoments::ValueMoments(const ValueKeys& keys, bool sums) {
  if (sums && !keys.is_small()) exact_ = std::make_unique<Sums>();
}

void ValueMoments::add(const ValueKeys& keys, std::uint64_t key) {
  if (!keys.is_finite(key)) {
    ++nonfinite_;
    return;
  }
  ++count_;
  least_ = std::min(least_, key);
  most_ = std::max(most_, key);
  if (keys.is_small()) {
    const auto value = static_cast<std::int64_t>(keys.whole(key));
    sum_ += value;
    squares_ += Int128{value} * value;
  } else if (exact_ && keys.is_whole()) {
    add_whole(exact_->values, keys.whole(key));
    add_square(exact_->squares, keys.whole(key));
  } else if (exact_) {
    const double value = keys.real(key);
    exact_->values.add(value);
    exact_->squares.add_product(value, value);
  }
}

ValueMoments::Sums ValueMoments::sums() const {
  if (exact_) return *exact_;
  Sums sums;
  add_whole(sums.values, sum_);
  add_whole(sums.squares, squares_);
  return sums;
}

std::optional<double> ValueMoments::mean() const {
  if (count_ == 0) return std::nullopt;
  return if_finite(sums().values.rounded() / static_cast<double>(count_));
}

std::optional<double> ValueMoments::deviation() const {
  if (count_ < 2) return std::nullopt;
  const auto n = static_cast<double>(count_);
  const Sums sums = this->sums();
  if (!if_finite(sums.squares.rounded())) return std::nullopt;
  return if_finite(std::sqrt(n_squared_variance(sums.values, sums.squares, n) / n / (n - 1)));
}

std::uint64_t ValueMoments::bytes(const ValueKeys& keys, bool sums) {
  return sizeof(ValueMoments) + (sums && !keys.is_small() ? sizeof(Sums) : 0);
}

namespace {

/// The greatest magnitude of a value in widths. Up to this number, integers and their products with 1, 2 and 5 are
/// exact in float64, and no two edges are equal.
constexpr double kMostMultiple = 0x1p50;

/// Returns a / b rounded down; b > 0.
Int128 floor_of_quotient(Int128 a, Int128 b) { return a / b - (a % b < 0 ? 1 : 0); }

}  // namespace

HistogramBins::HistogramBins(const ValueKeys& keys, std::uint64_t least, std::uint64_t most, std::uint64_t wanted) {
  const double lo = keys.real(least), hi = keys.real(most), bins = static_cast<double>(wanted);
  const double greatest = std::max(std::abs(lo), std::abs(hi));
  const double least_width = std::max(hi / bins - lo / bins, greatest / kMostMultiple);
  int exponent = least == most || least_width == 0 ? 0 : static_cast<int>(std::floor(std::log10(least_width)));
  if (keys.is_whole()) exponent = std::max(exponent, 0);
  for (;; ++exponent) {
    for (const int digit : {1, 2, 5}) {
      set_width(digit, exponent);
      if (!(greatest / edge(1) <= kMostMultiple)) continue;
      first_ = multiple_below(keys, least);
      last_ = multiple_below(keys, most);
      if (static_cast<std::uint64_t>(last_ - first_) < wanted) return;
    }
  }
}

void HistogramBins::set_width(int digit, int exponent) {
  digit_ = digit;
  exponent_ = exponent;
  power_ = std::pow(10.0, std::abs(exponent));
  whole_width_ = digit;
  for (int i = 0; i < std::min(exponent, 19); ++i) whole_width_ *= 10;
}

/// Returns multiple * digit_ * 10^exponent_, correctly rounded for exponents of -22 to 22; infinite beyond the range of
/// float64.
double HistogramBins::edge(std::int64_t multiple) const {
  const double units = static_cast<double>(multiple) * digit_;
  return exponent_ < 0 ? units / power_ : units * power_;
}

std::int64_t HistogramBins::multiple_below(const ValueKeys& keys, std::uint64_t key) const {
  if (keys.is_whole()) return static_cast<std::int64_t>(floor_of_quotient(keys.whole(key), whole_width_));
  const double value = keys.real(key);
  auto multiple = static_cast<std::int64_t>(std::floor(value / edge(1)));
  while (value < edge(multiple)) --multiple;
  while (value >= edge(multiple + 1)) ++multiple;
  return multiple;
}

std::vector<double> HistogramBins::edges() const {
  constexpr double kMost = std::numeric_limits<double>::max();
  std::vector<double> edges;
  for (std::size_t bin = 0; bin <= size(); ++bin)
    edges.push_back(std::clamp(edge(first_ + static_cast<std::int64_t>(bin)), -kMost, kMost));
  return edges;
}

std::size_t HistogramBins::bin_of(const ValueKeys& keys, std::uint64_t key) const {
  return static_cast<std::size_t>(std::clamp(multiple_below(keys, key), first_, last_) - first_);
}

void fail_of_changed_points() {
  fail("The points have changed while they were read; make the statistics again when nothing writes to the files.");
}

RankSearch::RankSearch(std::uint64_t count, std::uint64_t least, std::uint64_t most) {
  if (count == 0) return;
  found_.fill(least);
  if (least == most) return;
  for (std::size_t r = 0; r < kRanks; ++r) ranks_[r] = quantile_rank(count, PointStatistics::kPercent[r]);
  intervals_.push_back({least, most, count, 0, kRanks});
}

void RankSearch::begin(std::uint64_t share, std::uint64_t& next) {
  for (Interval& interval : intervals_) {
    const std::uint64_t span = interval.most - interval.least;
    interval.takes_keys = interval.count <= share;
    interval.taken = interval.shift = 0;
    while (span >> interval.shift >= share) ++interval.shift;
    interval.at = next;
    next += interval.takes_keys ? interval.count : (span >> interval.shift) + 1;
  }
}

void RankSearch::add(std::uint64_t key, std::span<std::uint64_t> room) {
  for (Interval& interval : intervals_) {
    if (key > interval.most) continue;
    if (key < interval.least) return;
    if (++interval.taken > interval.count) fail_of_changed_points();
    if (interval.takes_keys)
      room[interval.at + interval.taken - 1] = key;
    else
      ++room[interval.at + ((key - interval.least) >> interval.shift)];
    return;
  }
}

void RankSearch::divide(const Interval& interval, std::span<std::uint64_t> room, std::vector<Interval>& parts) {
  if (interval.taken != interval.count) fail_of_changed_points();
  if (interval.takes_keys) {
    const std::span<std::uint64_t> keys = room.subspan(interval.at, interval.count);
    std::ranges::sort(keys);
    for (std::size_t r = interval.first; r < interval.last; ++r) found_[r] = keys[ranks_[r]];
    return;
  }
  std::uint64_t before = 0;  // number of keys in earlier parts
  std::uint64_t part = 0;
  for (std::uint8_t r = interval.first; r < interval.last;) {
    while (before + room[interval.at + part] <= ranks_[r]) before += room[interval.at + part++];
    const std::uint64_t inside = room[interval.at + part], least = interval.least + (part << interval.shift);
    const std::uint64_t further =
        (std::uint64_t{1} << interval.shift) - 1;  // the part spans keys from `least` to at most `least` + `further`
    const std::uint8_t first = r;
    for (; r < interval.last && ranks_[r] < before + inside; ++r) {
      ranks_[r] -= before;
      found_[r] = least;
    }
    if (further > 0) parts.push_back({least, least + std::min(further, interval.most - least), inside, first, r});
  }
}

void RankSearch::end(std::span<std::uint64_t> room) {
  std::vector<Interval> parts;
  for (const Interval& interval : intervals_) divide(interval, room, parts);
  intervals_ = std::move(parts);
}

}  // namespace pointsweep
