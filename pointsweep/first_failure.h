// SPDX-License-Identifier: MIT
/// The exception of a parallel loop: the exception at the lowest index or row, independent of the order of threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <limits>
#include <mutex>

namespace pointsweep {

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

}  // namespace pointsweep
