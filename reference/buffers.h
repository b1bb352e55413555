// SPDX-License-Identifier: MIT
/// Buffers of operators (paper Section 5.2): the through-buffer, which never waits; the pre-buffer, in which a point
/// waits for its neighbours; and the pre- and post-buffer, in which also the neighbours wait for the point.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/points/degenerate_points.h"
#include "pointsweep/row_error.h"
#include "reference/fields.h"
#include "reference/stream_operators.h"

namespace pointsweep::reference {

/// Applies an operator of the engine. Operators take batches in columns, so the points that an operator may process at
/// one moment are gathered into batches, a few points at a time.
class OperatorCall {
 public:
  /// `between`: called after each batch of points.
  OperatorCall(const Stage& stage, std::function<void()> between) : stage_(stage), between_(std::move(between)) {}

  /// Makes the copies of a point's fields that the stage needs (Stage::copies). Must be called when the point enters
  /// the buffer.
  void copy_fields(StreamPoint& point) const;
  void apply(std::span<StreamPoint* const> points);
  const DegenerateRows& degenerate() const { return degenerate_; }
  /// Returns the error of the lowest row so far that the operator refuses.
  const FirstRowError& refused() const { return refused_; }

 private:
  /// Positions, rows and values of some points, in columns.
  struct Gathered {
    std::vector<double> x, y, z;
    std::vector<std::uint64_t> row;
    std::vector<std::vector<std::byte>> values;

    void start(std::size_t attributes);
    void add(Vec3 position, const StreamPoint& point);
    void add_values(StreamPoint& point, const std::vector<Field>& fields);
  };
  void gather(std::span<StreamPoint* const> points);
  void lay_out_slots();
  void apply_gathered(std::span<StreamPoint* const> points);

  const Stage& stage_;
  std::function<void()> between_;
  Gathered own_, near_;
  std::vector<std::uint32_t> begin_, refs_;
  std::vector<const std::byte*> pointers_;  ///< columns of the slots
  std::vector<PointColumns> slots_;
  DegenerateRows degenerate_;
  FirstRowError refused_;
};

/// An operator that moves no points and reads no attributes of neighbours (only positions). It processes points as soon
/// as they come (Section 5.2.1, Figures 12 and 13).
class ThroughBuffer final : public StreamOperator {
 public:
  explicit ThroughBuffer(OperatorCall& call) : call_(call) {}

  void pull_push() override;
  StreamPoint* front() override { return fifo_.empty() ? nullptr : fifo_.front(); }
  void pop_front() override { fifo_.pop_front(); }
  /// All points in the queue have been processed, so only earlier operators hold unprocessed points.
  std::uint64_t smallest_element() override { return prev_->smallest_element(); }
  std::uint64_t smallest_reference() override { return prev_->smallest_reference(); }
  std::size_t size() const override { return fifo_.size(); }

 private:
  OperatorCall& call_;
  std::deque<StreamPoint*> fifo_;
  std::vector<StreamPoint*> pulled_;
};

/// An operator that reads attributes of neighbours, such as curvature: the paper's "simplified" buffer. A point waits
/// until all its neighbours have passed the previous operator (StreamOperator::smallest_element()).
class PreBuffer : public StreamOperator {
 public:
  explicit PreBuffer(OperatorCall& call) : call_(call) {}

  void pull_push() override;
  StreamPoint* front() override { return fifo2_.empty() ? nullptr : fifo2_.front(); }
  void pop_front() override { fifo2_.pop_front(); }
  std::uint64_t smallest_element() override;
  std::uint64_t smallest_reference() override;
  std::size_t size() const override { return fifo1_.size() + fifo2_.size(); }

 protected:
  virtual bool may_be_processed(const StreamPoint& point) { return point.max_index < prev_->smallest_element(); }

  std::deque<StreamPoint*> fifo1_;  ///< points that wait for neighbours
  std::deque<StreamPoint*> fifo2_;  ///< processed points, not yet released

 private:
  OperatorCall& call_;
  ReferenceHeap references_;
  std::vector<StreamPoint*> ready_;
};

/// An operator that moves points, such as fairing. No operator before or after it may see a neighbourhood with both
/// moved and unmoved points: a point also waits until no point in an earlier operator refers to it, and is released
/// when all its neighbours are moved. The operator reads copies of its neighbours, made as they entered its buffer.
class PrePostBuffer final : public PreBuffer {
 public:
  using PreBuffer::PreBuffer;

  StreamPoint* front() override {
    StreamPoint* first = PreBuffer::front();
    return first != nullptr && (fifo1_.empty() || first->max_index < fifo1_.front()->index) ? first : nullptr;
  }

 protected:
  bool may_be_processed(const StreamPoint& point) override {
    return PreBuffer::may_be_processed(point) && point.index < prev_->smallest_reference();
  }
};

}  // namespace pointsweep::reference
