// SPDX-License-Identifier: MIT
#include "pointsweep/info/rank_search.h"

#include <algorithm>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/math/quantile_rank.h"

namespace pointsweep {

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
    const std::uint64_t further = (std::uint64_t{1} << interval.shift) - 1;  // keys of the part after its least
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
