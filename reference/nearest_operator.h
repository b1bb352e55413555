// SPDX-License-Identifier: MIT
/// The neighbourhood operator Φ_X: k nearest neighbours in one sweep (paper Section 4.2.2), and neighbourhoods whose
/// size differs from point to point, which the paper leaves open: "k or d ... could as well be derived for each point"
/// (Section 4.1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/neighborhood.h"
#include "reference/fields.h"
#include "reference/kd_heap.h"
#include "reference/stream_operator.h"

namespace pointsweep::reference {

/// A copy of the values of a point that the rule reads. The point itself may have left the active set.
struct RuledPoint {
  Vec3 position;
  std::uint64_t row;
  std::vector<std::byte> attributes;  ///< attributes that the rule reads, one after another
};

/// Decides how many of the neighbours found the rule of the task keeps. Without a rule, all are kept.
class Shortening {
 public:
  Shortening(SharedRule rule, const Fields& fields) : rule_(std::move(rule)), reads_(fields.rule_reads()) {}

  explicit operator bool() const { return static_cast<bool>(rule_); }
  RuledPoint ruled(StreamPoint& point) const;
  /// Returns how many of the neighbours of a point are kept, from the nearest on. `nearest_first`: all neighbours
  /// found.
  std::size_t kept(const RuledPoint& point, std::span<const Rank> nearest_first);
  /// Shortens the neighbours found to N_i. Must be called after NearestSet::sort().
  void shorten(StreamPoint& point);

 private:
  SharedRule rule_;
  std::vector<Field> reads_;
  std::vector<double> x_, y_, z_;  ///< neighbours in columns
  std::vector<std::uint64_t> row_;
  std::vector<NeighborRef> refs_;
  std::vector<PointColumns> slots_;
};

/// Returns copies of the neighbours found, independent of the active set.
std::vector<Rank> ranks_of(std::span<const Neighbor> neighbors);

/// Finds the neighbours of all points in one sweep. When the plane meets p_j, the left-sided set of p_j is found among
/// the points in S, p_j is offered to the right-sided sets of the points in S that reach it, and p_j enters S. Then
/// every point whose neighbourhood ends before the plane leaves S for the sorting buffer B, which restores the order of
/// the stream: its smallest point is released when nothing in S is smaller. After the end of the stream one point of S
/// is completed at a time.
///
/// The operator is a pre- and post-buffer with S as FIFO1 and B as FIFO2 (Section 5.2.2).
///
/// The result is approximate, as in the paper: a point that left S is not found by later points, however far they
/// reach. Audit counts what this costs.
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

  std::size_t searched() const { return searched_.size(); }  ///< number of points in S
  /// Returns the points that came in the last pull_push(); completed() returns the points that left S in it.
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
