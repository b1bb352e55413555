// SPDX-License-Identifier: MIT
/// A run that Python waits for: it can be interrupted, and its callbacks come on the thread that waits.
#pragma once

#include <nanobind/nanobind.h>

#include <functional>

#include "pointsweep/run.h"

namespace pointsweep {

/// Python functions that are called during a run; None: no call.
struct Callbacks {
  nanobind::object progress;  ///< (phase, points done, points in all)
  nanobind::object warn;      ///< (sentence)
};

/// Calls work(observer) on another thread, without the interpreter lock. Meanwhile the calling thread handles Python's
/// signals and makes the callbacks. Their exceptions, such as KeyboardInterrupt, cancel the work and are thrown when it
/// has ended; otherwise the exception of the work is thrown.
void watch(const Callbacks& callbacks, const std::function<void(Observer&)>& work);

}  // namespace pointsweep
