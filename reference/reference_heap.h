// SPDX-License-Identifier: MIT
/// The heap of referenced indices that a pre- and post-buffer keeps (paper Section 5.2.2, HeapOfPairs of Figure 14).
#pragma once

#include <cstdint>
#include <queue>
#include <vector>

#include "reference/stream_point.h"

namespace pointsweep::reference {

class ReferenceHeap {
 public:
  void push(const StreamPoint& p) { heap_.push({p.min_index, p.index}); }

  /// The smallest index that points from `smallest_element` on refer to; those before it have left. kNoIndex: none.
  std::uint64_t smallest(std::uint64_t smallest_element) {
    while (!heap_.empty() && heap_.top().index < smallest_element) heap_.pop();
    return heap_.empty() ? kNoIndex : heap_.top().referenced;
  }

 private:
  struct Pair {
    std::uint64_t referenced, index;
    bool operator>(const Pair& other) const { return referenced > other.referenced; }
  };
  std::priority_queue<Pair, std::vector<Pair>, std::greater<>> heap_;
};

}  // namespace pointsweep::reference
