// SPDX-License-Identifier: MIT
#include "reference/stream_point.h"

namespace pointsweep::reference {
namespace {

constexpr std::size_t kReserved = 512;  ///< initial capacity; larger sets grow

constexpr auto nearer = [](const Neighbor& a, const Neighbor& b) {
  return a.distance2 != b.distance2 ? a.distance2 < b.distance2 : a.rank() < b.rank();
};

}  // namespace

Rank Neighbor::rank() const { return {distance2, point->input, point->row}; }

bool NearestSet::offer(const Neighbor& candidate) {
  if (candidate.distance2 > reach2_) return false;
  if (full()) {
    if (!nearer(candidate, found_.front())) return false;
    std::pop_heap(found_.begin(), found_.end(), nearer);
    found_.back() = candidate;
  } else {
    if (found_.empty()) found_.reserve(std::min(k_, kReserved));
    found_.push_back(candidate);
  }
  std::push_heap(found_.begin(), found_.end(), nearer);
  if (full()) reach2_ = found_.front().distance2;
  return true;
}

void NearestSet::sort() { std::sort_heap(found_.begin(), found_.end(), nearer); }

}  // namespace pointsweep::reference
