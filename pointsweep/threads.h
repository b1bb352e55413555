// SPDX-License-Identifier: MIT
/// The threads of a run: parallel loops, the exception that a parallel loop throws, background tasks, and objects that
/// background tasks make ahead of their use. All parallel loops of the core but for_each_waiting()
/// (storage/remote/remote_object.h) go through this header, and only threads.cpp uses oneTBB.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

namespace pointsweep {

/// Calls work() so that the loops in it use up to `threads` threads, including the thread of work(). 0 counts as 1.
void with_threads(unsigned threads, const std::function<void()>& work);

/// Returns the number of threads of a loop that this thread starts: the number of with_threads(), or one for each core.
/// Each `worker` of a loop is lower than this number.
unsigned thread_count();

/// Calls body(i, worker) once for each i in [0, count). Calls of one loop with the same worker never run at once, so
/// that each worker can have its own memory. A body may itself call parallel_for, even while it holds a lock: its
/// thread then runs only bodies of the inner loop until that loop ends. Returns when all bodies have returned. An
/// exception ends the loop for all higher `i`; the exception of the lowest `i` is thrown, for any number of threads.
/// Bodies run in the caller's CancellationScope; Cancelled is thrown if its token is cancelled.
void parallel_for(std::size_t count, const std::function<void(std::size_t i, unsigned worker)>& body);

/// Calls body(first, n, worker) for successive blocks of `block` numbers that cover [0, count); the last block may be
/// shorter.
template <class Body>
void parallel_for_blocks(std::size_t count, std::size_t block, const Body& body) {
  parallel_for((count + block - 1) / block,
               [&](std::size_t b, unsigned worker) { body(b * block, std::min(block, count - b * block), worker); });
}

/// The exception of a parallel loop: the exception at the lowest index or row, independent of the order of threads.
class FirstFailure {
 public:
  /// Returns whether body `i` need not run, since a body with a lower index has failed.
  bool makes_needless(std::size_t i) const { return i > lowest_.load(std::memory_order_relaxed); }

  /// Calls work(), which is body `i`, and notes its exception, if any.
  template <class Work>
  void note_from(std::size_t i, const Work& work) {
    try {
      work();
    } catch (...) {
      note(i);
    }
  }

  /// Keeps the current exception, thrown by body `i`, unless a body with a lower index has failed.
  void note(std::size_t i) {
    const std::lock_guard lock(mutex_);
    if (error_ && i >= lowest_) return;
    lowest_ = i;
    error_ = std::current_exception();
  }

  /// Throws the stored exception, if any. Must be called after the loop.
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::atomic<std::size_t> lowest_ = std::numeric_limits<std::size_t>::max();
  std::mutex mutex_;
  std::exception_ptr error_;
};

/// A task in the background, on one of the threads of the run.
class BackgroundTask {
 public:
  explicit BackgroundTask(std::function<void()> work);
  ~BackgroundTask();  ///< waits for the task; drops an exception that wait() has not thrown
  BackgroundTask(const BackgroundTask&) = delete;
  BackgroundTask& operator=(const BackgroundTask&) = delete;
  /// Returns when the task is done; throws its exception.
  void wait();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A queue of the objects make(i) for i in [first, end), in order, of which up to `depth` (at least 1) are made ahead
/// in the background.
template <class Thing>
class Prefetch {
 public:
  Prefetch(std::function<Thing(std::size_t)> make, std::size_t first, std::size_t end, std::size_t depth)
      : make_(std::move(make)), next_(first), end_(end), depth_(depth) {
    fill();
  }

  /// Returns the next object, and starts to make a later object. Throws the exception that make() has thrown for the
  /// returned object. Must be called at most once for each object.
  Thing next() {
    pending_.front()->task->wait();
    Thing thing = std::move(*pending_.front()->thing);
    pending_.pop_front();
    fill();
    return thing;
  }

 private:
  struct Pending {
    std::optional<Thing> thing;
    std::optional<BackgroundTask> task;  // last member: its destructor waits for the task, which uses `thing`
  };

  void fill() {
    while (next_ < end_ && pending_.size() < depth_) {
      pending_.push_back(std::make_unique<Pending>());
      pending_.back()->task.emplace([this, &p = *pending_.back(), i = next_++] { p.thing.emplace(make_(i)); });
    }
  }

  std::function<Thing(std::size_t)> make_;
  std::size_t next_, end_, depth_;
  std::deque<std::unique_ptr<Pending>> pending_;
};

}  // namespace pointsweep
