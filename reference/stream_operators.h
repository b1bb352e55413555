// SPDX-License-Identifier: MIT
/// The interface of all operators of the stream, and three of them: the read operator Φ_R, the neighbourhood operator
/// Φ_X and the deferred-write operator Φ_W. buffers.h has the other operators.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/neighborhood.h"
#include "pointsweep/order/stream.h"
#include "reference/fields.h"
#include "reference/kd_heap.h"
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

  /// Returns an index below which all points have passed this operator; kNoIndex if all points have. In a
  /// through-buffer a point passes when it is processed, in all other operators when it is released.
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

  /// Returns the smallest index to which points with an index of at least `smallest_element` refer; kNoIndex without a
  /// reference. Points with a smaller index have left the operator.
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

/// The points of one slab of the stream (order/stream.h) in canonical order. Place 0 is the first point of the slab.
class SortedSlab {
 public:
  void load(const Stream& stream, std::size_t slab);

  std::size_t size() const { return order_.size(); }
  Vec3 position(std::size_t place) const { return {x_[order_[place]], y_[order_[place]], z_[order_[place]]}; }
  std::uint64_t row(std::size_t place) const { return row_[order_[place]]; }
  const std::byte* record(std::size_t place) const { return records_.data() + std::size_t{order_[place]} * stride_; }

 private:
  std::size_t stride_ = 0;
  std::vector<std::byte> records_;
  std::vector<double> x_, y_, z_;
  std::vector<std::uint64_t> row_;
  std::vector<std::uint32_t> order_;
};

/// Reads and buffers one point at a time, in canonical order. The slabs of the ordered stream, which the exact engine
/// uses as well, are read one by one and sorted.
class ReadOperator final : public StreamOperator {
 public:
  /// The slabs of `stream` must be in canonical order (StreamOptions::canonical): the search assumes that every unread
  /// point lies at or after the sweep plane.
  ReadOperator(const Stream& stream, const Fields& fields, Reach reach, ActiveSet& active);

  void pull_push() override;
  StreamPoint* front() override { return waiting_; }
  void pop_front() override { waiting_ = nullptr; }
  std::uint64_t smallest_element() override;
  std::uint64_t smallest_reference() override { return kNoIndex; }
  std::size_t size() const override { return waiting_ == nullptr ? 0 : 1; }

  std::uint64_t position() const { return position_; }  ///< number of points read
  std::uint64_t total() const { return total_; }
  /// Returns the error of the lowest row, among the rows read, with a value that an operator cannot read.
  const FirstRowError& refused() const { return refused_; }

 private:
  const Stream& stream_;
  const Fields& fields_;
  Reach reach_;
  ActiveSet& active_;
  StreamPoint* waiting_ = nullptr;
  std::uint64_t position_ = 0, total_ = 0;

  SortedSlab slab_;  ///< slab whose points are being read
  std::size_t next_slab_ = 0;
  std::size_t next_ = 0;  ///< place of the next point in slab_
  FirstRowError refused_;
};

/// Writes a point and removes it from the active set when no neighbourhood in earlier operators refers to it or to an
/// earlier point any more.
class WriteOperator final : public StreamOperator {
 public:
  WriteOperator(ActiveSet& active, std::function<void(StreamPoint&)> write)
      : active_(active), write_(std::move(write)) {}

  void pull_push() override;
  StreamPoint* front() override { return nullptr; }
  void pop_front() override {}
  std::uint64_t smallest_element() override { return fifo_.empty() ? prev_->smallest_element() : fifo_.front()->index; }
  std::uint64_t smallest_reference() override { return prev_->smallest_reference(); }
  std::size_t size() const override { return fifo_.size(); }

  std::uint64_t position() const { return position_; }  ///< number of points written

 private:
  ActiveSet& active_;
  std::function<void(StreamPoint&)> write_;
  std::deque<StreamPoint*> fifo_;
  std::uint64_t position_ = 0;
};

/// A copy of the values of a point that the rule reads. The point itself may have left the active set.
struct RuledPoint {
  Vec3 position;
  std::uint64_t row;
  std::vector<std::byte> attributes;  ///< attributes that the rule reads, one after another
};

/// Applies the rule of the neighbourhood (NeighborhoodRule), which keeps only the nearest of the neighbours found.
/// Without a rule, all neighbours are kept.
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
/// the stream: its smallest point is released when nothing in S is smaller. After the end of the stream each
/// pull_push() completes one point of S.
///
/// The operator is a pre- and post-buffer with S as FIFO1 and B as FIFO2 (Section 5.2.2).
///
/// The result is approximate, as in the paper: a point that left S is not found by later points, however far they
/// reach. Audit counts the neighbourhoods that are wrong for this reason.
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
  /// arrived() returns the points that came in the last pull_push(), completed() the points that left S in this call.
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
