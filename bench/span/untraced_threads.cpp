// SPDX-License-Identifier: MIT
#include "bench/span/untraced_threads.h"

#include "pointsweep/cancellation.h"

namespace untraced {
using namespace pointsweep;
}  // namespace untraced

/// Moves all declarations of threads.h and definitions of threads.cpp to the namespace untraced.
#define pointsweep untraced
#include "pointsweep/threads.cpp"
#undef pointsweep

namespace untraced {
namespace {

class OwnTask final : public Task {
 public:
  explicit OwnTask(std::function<void()> work) : task_(std::move(work)) {}
  void wait() override { task_.wait(); }

 private:
  BackgroundTask task_;
};

}  // namespace

std::unique_ptr<Task> start(std::function<void()> work) { return std::make_unique<OwnTask>(std::move(work)); }

}  // namespace untraced
