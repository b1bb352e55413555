// SPDX-License-Identifier: MIT
#include "reference/through_buffer.h"

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

}  // namespace pointsweep::reference
