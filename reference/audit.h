// SPDX-License-Identifier: MIT
/// The count of exact neighbourhoods among those found by NearestOperator. Not in the paper, which "observed no
/// difference" (Section 8) and does not say how it looked.
#pragma once

#include <cstdint>

#include "reference/kd_heap.h"
#include "reference/suspects.h"

namespace pointsweep::reference {

/// A neighbourhood can lack only points that left S before its own point came. Those still active are kept in a kD-heap
/// of their own, where the nearest of them are found as a point comes. Those already written lie before the last of
/// them along the axis; a neighbourhood that reaches so far is settled by reading them again. So the counts are exact:
/// `incomplete` neighbourhoods differ from the exact ones, after the rule of neighbourhoods if there is one.
///
/// The audit only observes the search. Its time is counted apart, so that the algorithm is measured without it.
class Audit {
 public:
  /// `stream` in canonical order, as the read operator reads it.
  Audit(const Stream& stream, Reach reach, Shortening& shortening)
      : sweep_axis_(stream.axis()), reach_(reach), shortening_(shortening), hidden_(sweep_axis_), suspects_(stream) {}

  /// Notes points in this order within a step of the sweep: the points that came, the points that left S, the points
  /// written.
  void arrived(StreamPoint& point);
  void completed(StreamPoint& point);
  void written(const StreamPoint& point);
  /// Before the counts are asked for.
  void finish() { settle(); }

  std::uint64_t complete() const { return complete_; }      ///< exact neighbourhoods
  std::uint64_t incomplete() const { return incomplete_; }  ///< neighbourhoods that are not exact
  /// Returns the bytes of the suspects that wait to be settled.
  std::uint64_t bytes() const { return suspects_.bytes(); }

 private:
  /// Takes from the point what was hidden from it.
  Suspect suspect(StreamPoint& point) const;
  void settle();
  void judge(const Suspect& suspect);

  int sweep_axis_;
  Reach reach_;
  Shortening& shortening_;
  KdHeap hidden_;  ///< active, and no longer in S
  Suspects suspects_;
  std::uint64_t written_ = 0;
  double written_to_ = 0;  ///< of the last point written: coordinate on the axis
  std::uint64_t complete_ = 0, incomplete_ = 0;
};

}  // namespace pointsweep::reference
