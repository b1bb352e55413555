// SPDX-License-Identifier: MIT
/// The deferred-write operator Φ_W (paper Section 4.2.1).
#pragma once

#include <deque>
#include <functional>
#include <utility>

#include "reference/stream_operator.h"

namespace pointsweep::reference {

/// A point is written, and leaves the active set, when no neighbourhood in the operators before refers to it any more.
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

  std::uint64_t position() const { return position_; }  ///< points written

 private:
  ActiveSet& active_;
  std::function<void(StreamPoint&)> write_;
  std::deque<StreamPoint*> fifo_;
  std::uint64_t position_ = 0;
};

}  // namespace pointsweep::reference
