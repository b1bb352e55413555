// SPDX-License-Identifier: MIT
/// The exception that a parallel loop throws: that of its lowest index or row, whichever thread comes first.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <limits>
#include <mutex>

namespace pointsweep {

class FirstFailure {
 public:
  /// Returns whether body `i` need not run, since one below it has failed.
  bool makes_needless(std::size_t i) const { return i > lowest_.load(std::memory_order_relaxed); }

  /// Calls work(), the body `i`, and takes what it throws.
  template <class Work>
  void note_from(std::size_t i, const Work& work) {
    try {
      work();
    } catch (...) {
      note(i);
    }
  }

  /// Takes the current exception of body `i`.
  void note(std::size_t i) {
    const std::lock_guard lock(mutex_);
    if (error_ && i >= lowest_) return;
    lowest_ = i;
    error_ = std::current_exception();
  }

  /// After the loop.
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::atomic<std::size_t> lowest_ = std::numeric_limits<std::size_t>::max();
  std::mutex mutex_;
  std::exception_ptr error_;
};

}  // namespace pointsweep
