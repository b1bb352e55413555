// SPDX-License-Identifier: MIT
#include "reference/write_operator.h"

#include <cassert>

namespace pointsweep::reference {

void WriteOperator::pull_push() {
  while (StreamPoint* point = prev_->front()) {
    prev_->pop_front();
    fifo_.push_back(point);
  }
  if (fifo_.empty()) return;
  const std::uint64_t needed = prev_->smallest_reference();
  for (; !fifo_.empty() && fifo_.front()->index < needed; ++position_) {
    assert(fifo_.front() == &active_.front() && "the active set is a queue");
    write_(*fifo_.front());
    fifo_.pop_front();
    active_.pop_front();
  }
}

}  // namespace pointsweep::reference
