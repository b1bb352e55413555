// SPDX-License-Identifier: MIT
/// Work that Python waits for: signals can interrupt it, and its callbacks are called on the waiting thread.
#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <functional>

#include "pointsweep/run.h"

namespace pointsweep {

/// Python functions that are called during a run; None: no call.
struct Callbacks {
  nanobind::object progress;  ///< (phase, points done, points in all)
  nanobind::object warn;      ///< (sentence)
};

/// Calls work(observer) on another thread, without the interpreter lock. Meanwhile the calling thread handles Python's
/// signals and makes the callbacks. The first exception of a signal, such as KeyboardInterrupt, or of a callback
/// cancels the work, ends the callbacks and is thrown when the work has ended; else an exception of the work is thrown
/// then.
void watch(const Callbacks& callbacks, const std::function<void(Observer&)>& work);

/// Reports the progress of work. Throws Cancelled if the work has been cancelled.
using Report = std::function<void(const char* phase, std::uint64_t done, std::uint64_t total)>;

/// Calls work(observer, report) like watch(), for work that is no run. Such work notices a cancellation when it calls
/// `report` or stop_if_cancelled().
void watch_reports(const Callbacks& callbacks, const std::function<void(Observer&, const Report&)>& work);

}  // namespace pointsweep
