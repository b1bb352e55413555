// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/read_ahead.h"

#include <oneapi/tbb/task_group.h>

#include <chrono>

#include "pointsweep/hand_over.h"

namespace pointsweep {

struct ReadAhead::Pending {
  LoadedSlab slab;
  double seconds = 0;
  HandOver begin, end;
  oneapi::tbb::task_group task;
};

ReadAhead::ReadAhead(const SlabLoader& loader, std::size_t slabs, std::size_t depth, bool keep_records)
    : loader_(loader), slabs_(slabs), depth_(depth), keep_records_(keep_records) {
  while (started_ < slabs_ && pending_.size() < depth_) start();
}

ReadAhead::~ReadAhead() {
  for (const auto& pending : pending_) {
    try {
      pending->task.wait();
    } catch (...) {  // the run has already failed of something else
    }
  }
}

void ReadAhead::start() {
  pending_.push_back(std::make_unique<Pending>());
  Pending& p = *pending_.back();
  const auto slab = static_cast<std::uint32_t>(started_++);
  p.begin.give();
  p.task.run([this, &p, slab] {
    p.begin.take();
    const auto start = std::chrono::steady_clock::now();
    p.slab = loader_.load(slab, keep_records_);
    p.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    p.end.give();
  });
}

LoadedSlab ReadAhead::next() {
  if (pending_.empty()) start();
  pending_.front()->task.wait();
  pending_.front()->end.take();
  LoadedSlab slab = std::move(pending_.front()->slab);
  seconds_ += pending_.front()->seconds;
  pending_.pop_front();
  while (started_ < slabs_ && pending_.size() < depth_) start();
  return slab;
}

}  // namespace pointsweep
