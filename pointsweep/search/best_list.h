// SPDX-License-Identifier: MIT
/// The k nearest candidates seen so far, in the exact order that defines a neighbourhood.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/neighborhood.h"

namespace pointsweep {

/// A point that may be a neighbour, with its squared distance from the point whose neighbours are searched.
struct Candidate {
  double distance2;
  Vec3 position;
  std::uint64_t row;
  NeighborRef ref;
};

/// The order of neighbours: by distance, equal distances by x, then y, then z, and only equal coordinates by row, so
/// that shuffling the input cannot change a geometric result.
inline bool nearer(const Candidate& a, const Candidate& b) {
  if (a.distance2 != b.distance2) return a.distance2 < b.distance2;
  if (a.position.x != b.position.x) return a.position.x < b.position.x;
  if (a.position.y != b.position.y) return a.position.y < b.position.y;
  if (a.position.z != b.position.z) return a.position.z < b.position.z;
  return a.row < b.row;
}

/// Inserts `c` into an ordered list of `size` candidates, and keeps the `most` nearest. Returns the new size of the
/// list.
inline std::size_t insert_sorted(const Candidate& c, Candidate* list, std::size_t size, std::size_t most) {
  std::size_t place = size;
  if (size == most && !nearer(c, list[--place])) return size;
  for (; place > 0 && nearer(c, list[place - 1]); --place) list[place] = list[place - 1];
  list[place] = c;
  return std::min(size + 1, most);
}

/// Keeps up to 2k + 32 candidates, and then cuts them back to the k nearest: constant time per candidate on average.
class BestList {
 public:
  /// Begins a search. `reach2`: squared distance within which the neighbourhood is known to end; infinite if unknown.
  void start(const Neighborhood& what, double reach2 = std::numeric_limits<double>::infinity()) {
    k_ = what.k;
    limit_ = std::min(what.radius2(), reach2);
    full_ = false;
    kept_.clear();
  }
  /// Returns a squared distance. A candidate farther away cannot belong to the neighbourhood; a candidate at this
  /// distance may.
  double limit() const { return limit_; }
  /// Returns false only if `c` cannot belong to the neighbourhood.
  bool wants(const Candidate& c) const { return c.distance2 <= limit_ && !(full_ && nearer(worst_, c)); }
  void offer(const Candidate& c) {
    if (c.distance2 > limit_) return;
    kept_.push_back(c);
    if (kept_.size() >= k_ && (kept_.size() - k_ >= k_ + 32 || !full_)) cut();
  }
  /// Ends the search and returns the neighbourhood, nearest first.
  const std::vector<Candidate>& finish() {
    std::sort(kept_.begin(), kept_.end(), nearer);
    if (kept_.size() > k_) kept_.resize(k_);
    return kept_;
  }
  /// Returns whether k candidates are known, so that limit() is a bound of the squared distance of the kth nearest;
  /// otherwise limit() is as start() has set it.
  bool full() const { return full_; }

 private:
  void cut() {
    const auto kth = kept_.begin() + static_cast<std::ptrdiff_t>(k_) - 1;
    if (k_ == 0) return kept_.clear();
    std::nth_element(kept_.begin(), kth, kept_.end(), nearer);
    kept_.erase(kth + 1, kept_.end());
    full_ = true;
    limit_ = kept_.back().distance2;
    worst_ = kept_.back();
  }

  std::size_t k_ = 0;
  double limit_ = 0;
  bool full_ = false;
  Candidate worst_{};  ///< the kth nearest at the last cut(), if full
  std::vector<Candidate> kept_;
};

}  // namespace pointsweep
