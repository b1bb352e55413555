// SPDX-License-Identifier: MIT
// threads.h without oneTBB, for the thread sanitizer. Debian's oneTBB is built without the sanitizer, which would
// report false races in its structures and miss its synchronisation.
#if defined(__SANITIZE_THREAD__)

#include <algorithm>
#include <atomic>
#include <future>
#include <thread>
#include <vector>

#include "pointsweep/cancellation.h"
#include "pointsweep/threads.h"

namespace pointsweep {
namespace {

thread_local unsigned run_threads = 0;  ///< number of threads of the run of this thread; 0 outside of runs

class Loop {
 public:
  Loop(std::size_t count, const std::function<void(std::size_t, unsigned)>& body) : count_(count), body_(body) {}

  void work(unsigned worker) {
    const CancellationScope scope(token_);
    for (std::size_t i = next_++; i < count_ && !failure_.makes_needless(i); i = next_++) {
      failure_.note_from(i, [&] {
        stop_if_cancelled();
        body_(i, worker);
      });
    }
  }

  void rethrow() const { failure_.rethrow(); }

 private:
  std::size_t count_;
  const std::function<void(std::size_t, unsigned)>& body_;
  const CancellationToken* token_ = CancellationScope::current();
  std::atomic<std::size_t> next_ = 0;
  FirstFailure failure_;
};

}  // namespace

void with_threads(unsigned threads, const std::function<void()>& work) {
  struct Restore {
    unsigned before = run_threads;
    ~Restore() { run_threads = before; }
  } restore;
  run_threads = std::max(threads, 1u);
  work();
}

unsigned thread_count() { return run_threads != 0 ? run_threads : std::max(1u, std::thread::hardware_concurrency()); }

void parallel_for(std::size_t count, const std::function<void(std::size_t, unsigned)>& body) {
  Loop loop(count, body);
  std::vector<std::thread> others;
  const auto workers = static_cast<unsigned>(std::min<std::size_t>(thread_count(), count));
  for (unsigned worker = 1; worker < workers; ++worker) others.emplace_back([&loop, worker] { loop.work(worker); });
  loop.work(0);
  for (std::thread& other : others) other.join();
  loop.rethrow();
}

struct BackgroundTask::State {
  std::future<void> done;
};

BackgroundTask::BackgroundTask(std::function<void()> work) : state_(std::make_unique<State>()) {
  state_->done = std::async(std::launch::async,
                            [work = std::move(work), threads = thread_count(), token = CancellationScope::current()] {
                              const CancellationScope scope(token);
                              stop_if_cancelled();
                              run_threads = threads;
                              work();
                            });
}

BackgroundTask::~BackgroundTask() {
  if (state_->done.valid()) state_->done.wait();
}

void BackgroundTask::wait() {
  if (state_->done.valid()) state_->done.get();
}

}  // namespace pointsweep

#endif
