// SPDX-License-Identifier: MIT
/// The neighbourhood operator Φ_X: k nearest neighbours in one sweep (paper Section 4.2.2).
#pragma once

#include <queue>
#include <span>
#include <vector>

#include "reference/kd_heap.h"
#include "reference/shortening.h"
#include "reference/stream_operator.h"

namespace pointsweep::reference {

/// When the plane meets p_j, its left-sided set is found among the points in S, it is offered to the right-sided sets
/// of the points in S that reach it, and it enters S. Then every point whose neighbourhood ends before the plane leaves
/// S for the sorting buffer B, which restores the order of the stream: its smallest point is released when nothing in S
/// is smaller. After the end of the stream one point of S is completed at a time.
///
/// A pre- and post-buffer in which S stands for FIFO1 and B for FIFO2 (Section 5.2.2).
///
/// Approximate, as in the paper: a point that left S is not found by later points, however far they reach. Audit counts
/// what this costs.
class NearestOperator final : public StreamOperator {
 public:
  NearestOperator(int sweep_axis, Shortening& shortening)
      : sweep_axis_(sweep_axis), shortening_(shortening), searched_(sweep_axis) {}

  void pull_push() override;
  StreamPoint* front() override;
  void pop_front() override { sorting_.pop(); }
  std::uint64_t smallest_element() override;
  std::uint64_t smallest_reference() override;
  std::size_t size() const override { return searched_.size() + sorting_.size(); }

  std::size_t searched() const { return searched_.size(); }  ///< points in S
  /// Points that came, and those that were completed, in the last pull_push().
  std::span<StreamPoint* const> arrived() const { return arrived_; }
  std::span<StreamPoint* const> completed() const { return completed_; }

 private:
  void arrive(StreamPoint& point);
  void complete(StreamPoint& point);

  struct LaterIndex {
    bool operator()(const StreamPoint* a, const StreamPoint* b) const { return a->index > b->index; }
  };
  int sweep_axis_;
  Shortening& shortening_;
  KdHeap searched_;                                                                   ///< S
  std::priority_queue<StreamPoint*, std::vector<StreamPoint*>, LaterIndex> sorting_;  ///< B
  ReferenceHeap references_;
  std::vector<StreamPoint*> arrived_, completed_;
};

}  // namespace pointsweep::reference
