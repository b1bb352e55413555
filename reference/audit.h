// SPDX-License-Identifier: MIT
/// Which of the neighbourhoods found by NearestOperator are exact. Not in the paper, which "observed no difference"
/// (Section 8) and does not say how it looked.
#pragma once

#include <cstdint>

#include "reference/kd_heap.h"

namespace pointsweep::reference {

/// A neighbourhood lacks a point if that one left S before the search came. Those still active are kept in a kD-heap of
/// their own: the nearest of them is found as a point comes, and compared with the farthest neighbour in the end. Those
/// already written lie before the last of them along the axis: a neighbourhood that ends behind it lacks none.
///
/// It only looks on. Its time is told apart, so that the algorithm is measured without it.
class Audit {
 public:
  explicit Audit(int sweep_axis) : sweep_axis_(sweep_axis), hidden_(sweep_axis) {}

  /// In this order within a step of the sweep: the points that came, then those that left S, then those written.
  void arrived(StreamPoint& point);
  void completed(StreamPoint& point);
  void written(const StreamPoint& point);

  std::uint64_t complete() const { return complete_; }      ///< exact for certain
  std::uint64_t overlooked() const { return overlooked_; }  ///< a nearer point is known that is not in it
  std::uint64_t unknown() const { return unknown_; }        ///< it reaches to where points have been written

 private:
  int sweep_axis_;
  KdHeap hidden_;  ///< active, and no longer in S
  double written_to_ = 0;
  bool any_written_ = false;
  std::uint64_t complete_ = 0, overlooked_ = 0, unknown_ = 0;
};

}  // namespace pointsweep::reference
