// SPDX-License-Identifier: MIT
/// Declares the functions of threads.h in the namespace untraced, for threads_traced.cpp, which calls them and records
/// loops and tasks.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace untraced {

/// The functions of pointsweep/threads.h.
void with_threads(unsigned threads, const std::function<void()>& work);
unsigned thread_count();
void parallel_for(std::size_t count, const std::function<void(std::size_t i, unsigned worker)>& body);

/// A BackgroundTask of pointsweep/threads.h.
class Task {
 public:
  virtual ~Task() = default;  ///< waits for the end of the work
  virtual void wait() = 0;
};
std::unique_ptr<Task> start(std::function<void()> work);

}  // namespace untraced
