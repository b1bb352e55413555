// SPDX-License-Identifier: MIT
#include "reference/buffers.h"

#include <algorithm>

namespace pointsweep::reference {

void ThroughBuffer::pull_push() {
  pulled_.clear();
  while (StreamPoint* point = prev_->front()) {
    prev_->pop_front();
    pulled_.push_back(point);
  }
  call_.apply(pulled_);
  fifo_.insert(fifo_.end(), pulled_.begin(), pulled_.end());
}

void PreBuffer::pull_push() {
  while (StreamPoint* point = prev_->front()) {
    prev_->pop_front();
    references_.push(*point);
    call_.copy_fields(*point);
    fifo1_.push_back(point);
  }
  ready_.clear();
  for (; !fifo1_.empty() && may_be_processed(*fifo1_.front()); fifo1_.pop_front()) ready_.push_back(fifo1_.front());
  call_.apply(ready_);
  fifo2_.insert(fifo2_.end(), ready_.begin(), ready_.end());
}

std::uint64_t PreBuffer::smallest_element() {
  if (!fifo2_.empty()) return fifo2_.front()->index;
  if (!fifo1_.empty()) return fifo1_.front()->index;
  return prev_->smallest_element();
}

/// The paper's outline drops references when a point is released, and keeps the references of the last point (Figure
/// 15). Here references are dropped when this function reads them, so that none remain at the end of the stream.
std::uint64_t PreBuffer::smallest_reference() {
  return std::min(prev_->smallest_reference(), references_.smallest(smallest_element()));
}

}  // namespace pointsweep::reference
