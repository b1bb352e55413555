// SPDX-License-Identifier: MIT
/// Counts the neighbourhoods found by NearestOperator that are exact. The paper found all of them exact in tests
/// (Section 8), which it does not describe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/order/stream.h"
#include "reference/kd_heap.h"
#include "reference/stream_operators.h"

namespace pointsweep::reference {

/// The nearest of the points offered, nearest first.
class NearestRanks {
 public:
  /// `nearest_first`: points offered before; only the first k count.
  NearestRanks(Reach reach, std::vector<Rank> nearest_first);
  /// Returns the squared distance within which a point may enter.
  double reach2() const { return ranks_.size() == reach_.k ? ranks_.back().distance2 : reach_.radius2; }
  void offer(const Rank& rank);
  std::span<const Rank> ranks() const { return ranks_; }

 private:
  Reach reach_;
  std::vector<Rank> ranks_;
};

/// A neighbourhood that may not be exact, and the part of the exact neighbourhood that is known.
struct Suspect {
  RuledPoint point;
  std::vector<Rank> kept;  ///< the found N_i, after the rule
  NearestRanks exact;  ///< nearest of the found and hidden points; the first `written` points of the stream are missing
  std::uint64_t written;  ///< number of points that had been written when `point` came
};

/// Suspects whose exact result is not complete: it lacks the points that had been written before the suspect came.
/// These points are read again from the stream, for many suspects at a time.
class Suspects {
 public:
  explicit Suspects(const Stream& stream) : stream_(stream) {}

  void add(Suspect suspect);
  /// Returns whether the suspects take so much memory that they should be settled.
  bool full() const { return bytes_ > kMostBytes; }
  std::uint64_t bytes() const { return bytes_; }
  /// Completes the exact results of all suspects, and returns and removes the suspects.
  std::vector<Suspect> settled();

 private:
  static constexpr std::uint64_t kMostBytes = 1 << 20;
  void offer_slab(std::size_t slab, std::span<Suspect*> near);

  const Stream& stream_;
  std::vector<Suspect> waiting_;
  std::uint64_t bytes_ = 0;
  SortedSlab slab_;
};

/// Observes a search and counts inexact results. S is the kD-heap in which NearestOperator searches. A neighbourhood
/// can lack only points that left S before its own point came. Points that left S but are still active are in a
/// separate kD-heap, which is searched when a point comes. Points already written lie at or before the last written
/// point along the axis; if a neighbourhood reaches that far, these points are read again. So the counts are exact:
/// `incomplete` counts the neighbourhoods that differ from the exact ones. A rule of neighbourhoods (Shortening)
/// shortens the found list and the exact list before both are compared. The audit only observes. Its time is measured
/// separately from the algorithm, except for written().
class Audit {
 public:
  /// `stream`: the stream of the ReadOperator, in canonical order.
  Audit(const Stream& stream, Reach reach, Shortening& shortening)
      : sweep_axis_(stream.axis()), reach_(reach), shortening_(shortening), hidden_(sweep_axis_), suspects_(stream) {}

  /// The next three functions must be called in this order within a step of the sweep: for the points that came, the
  /// points that left S, and the points written.
  void arrived(StreamPoint& point);
  void completed(StreamPoint& point);
  void written(const StreamPoint& point);
  /// Must be called before the counts are read.
  void finish() { settle(); }

  std::uint64_t complete() const { return complete_; }      ///< exact neighbourhoods
  std::uint64_t incomplete() const { return incomplete_; }  ///< neighbourhoods that are not exact
  /// Returns the bytes of the suspects that wait to be settled.
  std::uint64_t bytes() const { return suspects_.bytes(); }

 private:
  /// Returns a suspect whose exact result contains the active points that were hidden from `point`.
  Suspect suspect(StreamPoint& point) const;
  void settle();
  void judge(const Suspect& suspect);

  int sweep_axis_;
  Reach reach_;
  Shortening& shortening_;
  KdHeap hidden_;  ///< active points that are no longer in S
  Suspects suspects_;
  std::uint64_t written_ = 0;
  double written_to_ = 0;  ///< coordinate of the last written point on the axis
  std::uint64_t complete_ = 0, incomplete_ = 0;
};

}  // namespace pointsweep::reference
