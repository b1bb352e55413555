// SPDX-License-Identifier: MIT
/// Points that differ from one reading to the next.
#pragma once

#include "pointsweep/fail.h"

namespace pointsweep {

[[noreturn]] inline void fail_of_changed_points() {
  fail("The points have changed while they were read; make the statistics again when nothing writes to the files.");
}

}  // namespace pointsweep
