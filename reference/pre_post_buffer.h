// SPDX-License-Identifier: MIT
/// Operators that must wait for their neighbours, and those whose neighbours must wait for them (paper Section 5.2.2,
/// Figures 14 and 15).
#pragma once

#include <deque>
#include <vector>

#include "reference/operator_call.h"
#include "reference/reference_heap.h"
#include "reference/stream_operator.h"

namespace pointsweep::reference {

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
