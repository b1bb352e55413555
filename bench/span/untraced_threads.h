// SPDX-License-Identifier: MIT
/// The threads of the library under another name, for the threads that record their tasks (threads_traced.cpp).
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
  virtual ~Task() = default;  ///< waits
  virtual void wait() = 0;
};
std::unique_ptr<Task> start(std::function<void()> work);

}  // namespace untraced
