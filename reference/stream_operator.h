// SPDX-License-Identifier: MIT
/// The common interface of all stream operators (paper Section 5.2 and Figure 11).
#pragma once

#include <cstddef>
#include <cstdint>
#include <queue>
#include <vector>

#include "reference/stream_point.h"

namespace pointsweep::reference {

/// An operator Φ_k with its buffer Q_k: a queue of points in stream order that pulls from the operator before it.
class StreamOperator {
 public:
  virtual ~StreamOperator() = default;

  /// Takes the points that the previous operator has released, and processes and releases as many points as possible.
  virtual void pull_push() = 0;
  /// Returns the next point to be released; null if there is none now.
  virtual StreamPoint* front() = 0;
  virtual void pop_front() = 0;

  /// Returns an index below which all points have been released to the next operator, or to a later one; kNoIndex if
  /// all points have been released.
  virtual std::uint64_t smallest_element() = 0;
  /// Returns a lower bound of the indices to which the points in this operator and in earlier operators refer.
  virtual std::uint64_t smallest_reference() = 0;
  /// Returns the number of points in the buffer.
  virtual std::size_t size() const = 0;

  void set_prev(StreamOperator& prev) { prev_ = &prev; }

 protected:
  StreamOperator* prev_ = nullptr;
};

/// The heap of referenced indices that a pre- and post-buffer keeps (paper Section 5.2.2, HeapOfPairs of Figure 14).
class ReferenceHeap {
 public:
  void push(const StreamPoint& p) { heap_.push({p.min_index, p.index}); }

  /// Returns the smallest index to which points from `smallest_element` on refer, since earlier points have left;
  /// kNoIndex without a reference.
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
