// SPDX-License-Identifier: MIT
#include "pointsweep/levels/leaf_finder.h"

#include <algorithm>
#include <utility>

namespace pointsweep {

const Leaf* leaf_around(std::span<const Leaf> leaves, const Octant& octant) {
  const auto behind = std::ranges::upper_bound(leaves, first_key(octant), {}, &Leaf::key);
  if (behind == leaves.begin()) return nullptr;
  const Leaf& leaf = *std::prev(behind);
  if (leaf.depth > octant.depth) return nullptr;
  return octant_of(first_key(octant), leaf.depth) == octant_of(leaf.key, leaf.depth) ? &leaf : nullptr;
}

void LeafFinder::add(std::span<const CurveKey> keys) {
  for (const CurveKey& key : keys) {
    if (count_ > 0 && key != last_) {
      const int common = common_depth(last_, key);
      close(common + 1);
      std::fill(first_.begin() + common + 1, first_.end(), count_);
      first_at_last_ = count_;
    }
    last_ = key;
    ++count_;
  }
}

/// Ends the octants of the last point from `depth` down to the finest. The largest octant that need not be divided
/// becomes a leaf, and replaces the leaves within it.
void LeafFinder::close(int depth) {
  for (; depth <= kMostDepth; ++depth) {
    const std::uint64_t first = first_[static_cast<std::size_t>(depth)];
    const bool is_leaf = count_ - first <= kMostLeafPoints || first_at_last_ <= first || depth == kMostDepth;
    if (!is_leaf) continue;
    while (!leaves_.empty() && leaves_.back().first >= first) leaves_.pop_back();
    leaves_.push_back({first_key(octant_of(last_, depth)), depth, first, count_ - first});
    return;
  }
}

std::vector<Leaf> LeafFinder::finish() {
  if (count_ > 0) close(0);
  return std::move(leaves_);
}

}  // namespace pointsweep
