// SPDX-License-Identifier: MIT
#include "pointsweep/threads.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <algorithm>

#include "pointsweep/cancellation.h"
#include "pointsweep/first_failure.h"

#if !defined(__SANITIZE_THREAD__)  // threads_sanitized.cpp takes its place there

namespace pointsweep {

namespace tbb = oneapi::tbb;

namespace {

/// True while this thread runs a body of a loop or a task.
thread_local bool working = false;

class Working {
 public:
  Working() { working = true; }
  ~Working() { working = before_; }

 private:
  bool before_ = working;
};

}  // namespace

void with_threads(unsigned threads, const std::function<void()>& work) {
  threads = std::max(threads, 1u);
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  tbb::task_arena arena(static_cast<int>(threads));
  const CancellationToken* const token = CancellationScope::current();
  arena.execute([&] {  // perhaps by another thread
    const CancellationScope scope(token);
    work();
  });
}

unsigned thread_count() { return static_cast<unsigned>(tbb::this_task_arena::max_concurrency()); }

void parallel_for(std::size_t count, const std::function<void(std::size_t, unsigned)>& body) {
  const CancellationToken* const token = CancellationScope::current();
  FirstFailure failure;
  const auto loop = [&] {
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
      if (failure.makes_needless(i)) return;
      const Working mark;
      const CancellationScope scope(token);
      failure.note_from(i, [&] {
        stop_if_cancelled();
        body(i, static_cast<unsigned>(tbb::this_task_arena::current_thread_index()));
      });
    });
  };
  // While a body waits for its inner loop, its thread must not start another body, since the body may hold a lock.
  working ? tbb::this_task_arena::isolate(loop) : loop();
  failure.rethrow();
}

struct BackgroundTask::State {
  tbb::task_group group;
};

BackgroundTask::BackgroundTask(std::function<void()> work) : state_(std::make_unique<State>()) {
  state_->group.run([work = std::move(work), token = CancellationScope::current()] {
    const Working mark;
    const CancellationScope scope(token);
    stop_if_cancelled();
    work();
  });
}

BackgroundTask::~BackgroundTask() {
  try {
    state_->group.wait();
  } catch (...) {  // the run has already failed with another error
  }
}

void BackgroundTask::wait() { state_->group.wait(); }

}  // namespace pointsweep

#endif
