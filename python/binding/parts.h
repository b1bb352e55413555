// SPDX-License-Identifier: MIT
/// Tasks of a run that many processes perform.
#pragma once

#include <nanobind/nanobind.h>

namespace pointsweep {

/// Adds the functions that plan such a run, perform a task, join the results of tasks, and remove what tasks left.
void bind_parts(nanobind::module_& module);

}  // namespace pointsweep
