// SPDX-License-Identifier: MIT
#include "pointsweep/sweep/read_ahead.h"

#include <chrono>
#include <optional>

#include "pointsweep/threads.h"

namespace pointsweep {

struct ReadAhead::Pending {
  LoadedSlab slab;
  double seconds = 0;
  std::optional<BackgroundTask> task;  // last, so that it ends before what it works on
};

ReadAhead::ReadAhead(const SlabLoader& loader, std::size_t first, std::size_t slabs, std::size_t depth,
                     bool keep_records)
    : loader_(loader), started_(first), slabs_(slabs), depth_(depth), keep_records_(keep_records) {
  while (started_ < slabs_ && pending_.size() < depth_) start();
}

ReadAhead::~ReadAhead() = default;

void ReadAhead::start() {
  pending_.push_back(std::make_unique<Pending>());
  Pending& p = *pending_.back();
  const auto slab = static_cast<std::uint32_t>(started_++);
  p.task.emplace([this, &p, slab] {
    const auto start = std::chrono::steady_clock::now();
    p.slab = loader_.load(slab, keep_records_);
    p.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  });
}

LoadedSlab ReadAhead::next() {
  if (pending_.empty()) start();
  pending_.front()->task->wait();
  LoadedSlab slab = std::move(pending_.front()->slab);
  seconds_ += pending_.front()->seconds;
  pending_.pop_front();
  while (started_ < slabs_ && pending_.size() < depth_) start();
  return slab;
}

}  // namespace pointsweep
