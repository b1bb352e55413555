// SPDX-License-Identifier: MIT
#include "reference/audit.h"

#include <algorithm>
#include <cassert>
#include <iterator>
#include <utility>

namespace pointsweep::reference {
namespace {

bool may_hold_neighbors(const Slab& slab, const Suspect& suspect) {
  return slab.first < suspect.written && distance2(slab.box, suspect.point.position) <= suspect.exact.reach2();
}

/// Returns the first place in the slab, below `end`, whose point is near enough to the suspect's point along the axis
/// to be a neighbour; `end` if there is none.
std::size_t first_within(const SortedSlab& slab, int axis, const Suspect& suspect, std::size_t end) {
  std::size_t low = 0;
  while (low < end) {
    const std::size_t middle = low + (end - low) / 2;
    const double ahead = suspect.point.position[axis] - slab.position(middle)[axis];
    ahead* ahead > suspect.exact.reach2() ? low = middle + 1 : end = middle;
  }
  return low;
}

bool same(const Rank& a, const Rank& b) { return a.row == b.row; }

/// Returns whether no point that had been written when `point` came can be within `reach2` of it.
bool nothing_written_within(double reach2, const StreamPoint& point) {
  return point.written == 0 || reach2 < point.written2;
}

}  // namespace

NearestRanks::NearestRanks(Reach reach, std::vector<Rank> nearest_first)
    : reach_(reach), ranks_(std::move(nearest_first)) {
  if (ranks_.size() > reach_.k) ranks_.erase(ranks_.begin() + static_cast<std::ptrdiff_t>(reach_.k), ranks_.end());
}

void NearestRanks::offer(const Rank& rank) {
  if (rank.distance2 > reach2()) return;
  ranks_.insert(std::upper_bound(ranks_.begin(), ranks_.end(), rank), rank);
  if (ranks_.size() > reach_.k) ranks_.pop_back();
}

void Suspects::add(Suspect suspect) {
  bytes_ += sizeof(Suspect) + suspect.point.attributes.size() +
            (suspect.kept.size() + suspect.exact.ranks().size()) * sizeof(Rank);
  waiting_.push_back(std::move(suspect));
}

std::vector<Suspect> Suspects::settled() {
  std::vector<Suspect*> near;
  for (std::size_t s = 0; s < stream_.slabs().size() && !waiting_.empty(); ++s) {
    near.clear();
    for (Suspect& suspect : waiting_)
      if (may_hold_neighbors(stream_.slabs()[s], suspect)) near.push_back(&suspect);
    if (!near.empty()) offer_slab(s, near);
  }
  bytes_ = 0;
  return std::exchange(waiting_, {});
}

void Suspects::offer_slab(std::size_t slab, std::span<Suspect*> near) {
  slab_.load(stream_, slab);
  for (Suspect* suspect : near) {
    const Vec3 p = suspect->point.position;
    const std::size_t end = std::min<std::uint64_t>(slab_.size(), suspect->written - stream_.slabs()[slab].first);
    for (std::size_t i = first_within(slab_, stream_.axis(), *suspect, end); i < end; ++i)
      suspect->exact.offer({distance2(slab_.position(i), p), slab_.position(i), slab_.row(i)});
  }
}

void Audit::arrived(StreamPoint& point) {
  NearestSet nearest({.k = reach_.k, .radius2 = point.neighbors.reach2()});
  hidden_.find_nearest(point.input, nearest);
  nearest.sort();
  point.hidden = ranks_of(nearest.found());
  point.written = written_;
  const double behind = point.input[sweep_axis_] - written_to_;
  point.written2 = behind * behind;
}

void Audit::completed(StreamPoint& point) {
  hidden_.insert(point);
  if (point.hidden.empty() && nothing_written_within(point.neighbors.reach2(), point)) {
    ++complete_;
    return;
  }
  Suspect found = suspect(point);
  if (nothing_written_within(found.exact.reach2(), point)) return judge(found);
  suspects_.add(std::move(found));
  if (suspects_.full()) settle();
}

Suspect Audit::suspect(StreamPoint& point) const {
  const std::vector<Rank> found = ranks_of(point.neighbors.found()), hidden = std::exchange(point.hidden, {});
  std::vector<Rank> known;
  std::merge(found.begin(), found.end(), hidden.begin(), hidden.end(), std::back_inserter(known));
  return {.point = shortening_.ruled(point),
          .kept = ranks_of(point.neighbors.kept()),
          .exact = {reach_, std::move(known)},
          .written = point.written};
}

void Audit::settle() {
  for (const Suspect& suspect : suspects_.settled()) judge(suspect);
}

void Audit::judge(const Suspect& suspect) {
  const std::size_t count = shortening_.kept(suspect.point, suspect.exact.ranks());
  const auto exact = suspect.exact.ranks().first(count);
  const bool equal = std::equal(suspect.kept.begin(), suspect.kept.end(), exact.begin(), exact.end(), same);
  ++(equal ? complete_ : incomplete_);
}

void Audit::written(const StreamPoint& point) {
  assert(&hidden_.smallest() == &point);
  hidden_.pop_smallest();
  written_to_ = point.input[sweep_axis_];
  ++written_;
}

}  // namespace pointsweep::reference
