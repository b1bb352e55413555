// SPDX-License-Identifier: MIT
/// Buffers of operators (paper Section 5.2): the through-buffer, operators that must wait for their neighbours, and
/// operators whose neighbours must wait for them.
#pragma once

#include <deque>
#include <vector>

#include "reference/operator_call.h"
#include "reference/stream_operator.h"

namespace pointsweep::reference {

/// An operator that adds attributes to a point and looks at nothing that operators make of its neighbours. It processes
/// points as soon as they come (Section 5.2.1, Figures 12 and 13).
class ThroughBuffer final : public StreamOperator {
 public:
  explicit ThroughBuffer(OperatorCall& call) : call_(call) {}

  void pull_push() override;
  StreamPoint* front() override { return fifo_.empty() ? nullptr : fifo_.front(); }
  void pop_front() override { fifo_.pop_front(); }
  /// Points in the queue have been processed: only the operators before hold unprocessed points.
  std::uint64_t smallest_element() override { return prev_->smallest_element(); }
  std::uint64_t smallest_reference() override { return prev_->smallest_reference(); }
  std::size_t size() const override { return fifo_.size(); }

 private:
  OperatorCall& call_;
  std::deque<StreamPoint*> fifo_;
  std::vector<StreamPoint*> pulled_;
};

/// An operator that looks at what earlier operators made of its neighbours, such as curvature: the paper's "simplified"
/// buffer. A point waits until all its neighbours have been released by the operator before.
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

  std::deque<StreamPoint*> fifo1_;  ///< deferred
  std::deque<StreamPoint*> fifo2_;  ///< processed

 private:
  OperatorCall& call_;
  ReferenceHeap references_;
  std::vector<StreamPoint*> ready_;
};

/// An operator that moves points, such as fairing. No operator before or after it may see a neighbourhood of which some
/// points are moved and some are not: a point also waits until no earlier point refers to it, and is released when all
/// its neighbours are moved. Within the operator, neighbours are seen through the copies made as they entered.
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
