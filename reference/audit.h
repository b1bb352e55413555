// SPDX-License-Identifier: MIT
/// The count of exact neighbourhoods among those found by NearestOperator. Not in the paper, which "observed no
/// difference" (Section 8) and does not say how it looked.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/order/stream.h"
#include "reference/kd_heap.h"
#include "reference/nearest_operator.h"
#include "reference/read_write_operators.h"

namespace pointsweep::reference {

/// The nearest of the points offered, nearest first.
class NearestRanks {
 public:
  /// `nearest_first`: points offered before; of these the first k count.
  NearestRanks(Reach reach, std::vector<Rank> nearest_first);
  /// Squared distance within which a point may enter.
  double reach2() const { return ranks_.size() == reach_.k ? ranks_.back().distance2 : reach_.radius2; }
  void offer(const Rank& rank);
  std::span<const Rank> ranks() const { return ranks_; }

 private:
  Reach reach_;
  std::vector<Rank> ranks_;
};

struct Suspect {
  RuledPoint point;
  std::vector<Rank> kept;  ///< N_i as the stages see it
  NearestRanks exact;      ///< what the search should have found, but for the first points of the stream,
  std::uint64_t written;   ///< so many, which had been written when the point came
};

/// Suspects that wait for the points that had been written. These are read again from the stream, many suspects at a
/// time.
class Suspects {
 public:
  explicit Suspects(const Stream& stream) : stream_(stream) {}

  void add(Suspect suspect);
  /// Returns whether so many suspects wait that they should be settled.
  bool full() const { return bytes_ > kMostBytes; }
  std::uint64_t bytes() const { return bytes_; }
  /// Completes what the search should have found, and returns and forgets the suspects.
  std::vector<Suspect> settled();

 private:
  static constexpr std::uint64_t kMostBytes = 1 << 20;
  void offer_slab(std::size_t slab, std::span<Suspect*> near);

  const Stream& stream_;
  std::vector<Suspect> waiting_;
  std::uint64_t bytes_ = 0;
  SortedSlab slab_;
};

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
