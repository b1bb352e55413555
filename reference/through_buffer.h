// SPDX-License-Identifier: MIT
/// The through-buffer: an operator that adds attributes to a point and looks at nothing that operators make of its
/// neighbours (paper Section 5.2.1, Figures 12 and 13).
#pragma once

#include <deque>
#include <vector>

#include "reference/operator_call.h"
#include "reference/stream_operator.h"

namespace pointsweep::reference {

/// Processes points as soon as they come.
class ThroughBuffer final : public StreamOperator {
 public:
  explicit ThroughBuffer(OperatorCall& call) : call_(call) {}

  void pull_push() override;
  StreamPoint* front() override { return fifo_.empty() ? nullptr : fifo_.front(); }
  void pop_front() override { fifo_.pop_front(); }
  /// Points in the queue have been processed: only the operators before hold unprocessed points.
  /// any.
  std::uint64_t smallest_element() override { return prev_->smallest_element(); }
  std::uint64_t smallest_reference() override { return prev_->smallest_reference(); }
  std::size_t size() const override { return fifo_.size(); }

 private:
  OperatorCall& call_;
  std::deque<StreamPoint*> fifo_;
  std::vector<StreamPoint*> pulled_;
};

}  // namespace pointsweep::reference
