// SPDX-License-Identifier: MIT
/// Cancellation: a signal handler or another thread can ask work of the library to end early.
#pragma once

#include "pointsweep/error.h"
#include "pointsweep/export.h"

namespace pointsweep {

/// While a scope exists, the work of its thread, and of other threads on behalf of this thread, stops once `token` is
/// cancelled. An inner scope replaces an outer scope; a scope with a null token has no effect.
class POINTSWEEP_EXPORT CancellationScope {
 public:
  explicit CancellationScope(const CancellationToken* token) noexcept : before_(current_) {
    if (token != nullptr) current_ = token;
  }
  ~CancellationScope() { current_ = before_; }
  CancellationScope(const CancellationScope&) = delete;
  CancellationScope& operator=(const CancellationScope&) = delete;

  /// Returns the token of this thread; null outside of every scope.
  static const CancellationToken* current() noexcept { return current_; }

 private:
  static inline thread_local constinit const CancellationToken* current_ = nullptr;
  const CancellationToken* before_;
};

/// Throws Cancelled if the token of this thread is cancelled. Takes about 1 ns. The loops of the library over much data
/// call it, so that a run ends within a fraction of a second. Operators are not interrupted, but get a bounded number
/// of neighbours at once.
inline void stop_if_cancelled() {
  if (const CancellationToken* token = CancellationScope::current(); token != nullptr && token->cancelled())
    throw Cancelled();
}

}  // namespace pointsweep
