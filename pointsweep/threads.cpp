// SPDX-License-Identifier: MIT
#include "pointsweep/threads.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "pointsweep/cancellation.h"

#if !defined(__SANITIZE_THREAD__)  // threads_sanitized.cpp replaces this file under the thread sanitizer

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

/// A limit of the number of threads of this process. If several limits exist, the least counts.
class ThreadLimit {
 public:
  explicit ThreadLimit(unsigned threads) : threads_(threads) { set(); }
  void set() { control_.emplace(tbb::global_control::max_allowed_parallelism, threads_); }
  void lift() { control_.reset(); }

 private:
  unsigned threads_;
  std::optional<tbb::global_control> control_;
};

/// The limit of the innermost with_threads() that this thread runs; null outside of with_threads().
thread_local ThreadLimit* limit_around = nullptr;

class LimitAround {
 public:
  explicit LimitAround(ThreadLimit* limit) : before_(std::exchange(limit_around, limit)) {}
  ~LimitAround() { limit_around = before_; }
  LimitAround(const LimitAround&) = delete;
  LimitAround& operator=(const LimitAround&) = delete;

 private:
  ThreadLimit* before_;
};

/// Lifts a limit while this object exists.
class LiftedLimit {
 public:
  explicit LiftedLimit(ThreadLimit* limit) : limit_(limit) {
    if (limit_ != nullptr) limit_->lift();
  }
  ~LiftedLimit() {
    if (limit_ != nullptr) limit_->set();
  }
  LiftedLimit(const LiftedLimit&) = delete;
  LiftedLimit& operator=(const LiftedLimit&) = delete;

 private:
  ThreadLimit* limit_;
};

}  // namespace

void with_threads(unsigned threads, const std::function<void()>& work) {
  threads = std::max(threads, 1u);
  const LiftedLimit outer(limit_around);  // the outer limit may be lower, and the outer threads only wait
  ThreadLimit limit(threads);
  tbb::task_arena arena(static_cast<int>(threads));
  const CancellationToken* const token = CancellationScope::current();
  arena.execute([&] {  // oneTBB may call this function on another thread
    const CancellationScope scope(token);
    const LimitAround around(&limit);
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
  // While a body waits for its inner loop, its thread must not start another body, since the waiting body may hold
  // a lock.
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
  } catch (...) {  // dropped, since the run has already failed with another error
  }
}

void BackgroundTask::wait() { state_->group.wait(); }

}  // namespace pointsweep

#endif
