// SPDX-License-Identifier: MIT
/// A run that Python waits for: it can be interrupted, and its callbacks come on the thread that waits.
#pragma once

#include <nanobind/nanobind.h>

#include <functional>

#include "pointsweep/run.h"

namespace pointsweep {

/// Calls of Python while a run goes on; None: no call.
struct Callbacks {
  nanobind::object progress;  ///< (phase, points done, points in all)
  nanobind::object warn;      ///< (sentence)
};

/// Calls work(observer) on a thread of its own, without the interpreter lock. Meanwhile the calling thread lets Python
/// handle signals and calls back. An exception of either, KeyboardInterrupt above all, cancels the work and is thrown
/// when it has ended; otherwise that of the work.
void watch(const Callbacks& callbacks, const std::function<void(Observer&)>& work);

}  // namespace pointsweep
