// SPDX-License-Identifier: MIT
/// The threads of a run: a loop over independent pieces of work, and one piece done in the background. The only header
/// that the rest of the library needs for them, and threads.cpp the only file that knows the library behind it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>

namespace pointsweep {

/// Calls work() so that the loops in it use `threads` threads (at least 1), the calling one among them.
void with_threads(unsigned threads, const std::function<void()>& work);

/// How many threads a loop started here uses: those of with_threads(), or one for each core. Workers are numbered below
/// it.
unsigned thread_count();

/// Calls body(i, worker) once for each i in [0, count). Calls with the same worker never run at once, so that each
/// worker can have its own memory. A body may itself call parallel_for, also while it holds a lock: its thread then
/// runs no other body until that loop ends. Returns when all have returned. An exception ends the loop for all higher
/// `i`, and that of the lowest `i` is thrown, for any number of threads. Cancelled is thrown if the caller's
/// CancellationScope asks to stop, in which the bodies run too.
void parallel_for(std::size_t count, const std::function<void(std::size_t i, unsigned worker)>& body);

/// The same over blocks: calls body(first, n, worker) for successive blocks of `block` numbers, the last of which may
/// be shorter, that cover [0, count).
template <class Body>
void parallel_for_blocks(std::size_t count, std::size_t block, const Body& body) {
  parallel_for((count + block - 1) / block,
               [&](std::size_t b, unsigned worker) { body(b * block, std::min(block, count - b * block), worker); });
}

/// One piece of work in the background, on one of the threads of the run.
class BackgroundTask {
 public:
  explicit BackgroundTask(std::function<void()> work);
  ~BackgroundTask();  ///< waits; an exception of a task that was not waited for is dropped
  BackgroundTask(const BackgroundTask&) = delete;
  BackgroundTask& operator=(const BackgroundTask&) = delete;
  /// Returns when the work is done; throws what it threw.
  void wait();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pointsweep
