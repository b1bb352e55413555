// SPDX-License-Identifier: MIT
/// The exceptions of the library, and the request to stop.
#pragma once

#include <atomic>
#include <stdexcept>

#include "pointsweep/export.h"

namespace pointsweep {

/// An error of the user, a file or the machine. `what()` is one sentence for the user: file, place (`line 7`, `byte
/// 312`, `stage 'normals'`) and remedy. Thrown during set-up, input and output, and for values of points that a stage
/// refuses; no half-written output remains, except bytes on standard output. Degenerate data cause no Error: they get a
/// documented value, and Statistics counts them.
class POINTSWEEP_EXPORT Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An impossible request: an option out of range, a chain that does not fit the cloud.
class POINTSWEEP_EXPORT UsageError : public Error {
 public:
  using Error::Error;
};

/// The caller asked to stop. Temporary files and outputs that are not complete are removed, as after any error.
class POINTSWEEP_EXPORT Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

/// A request to stop. Once made, it cannot be withdrawn. Lock-free: any thread and a signal handler may call cancel().
class POINTSWEEP_EXPORT CancellationToken {
 public:
  void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }

 private:
  std::atomic<bool> cancelled_ = false;
  static_assert(std::atomic<bool>::is_always_lock_free);
};

}  // namespace pointsweep
