// SPDX-License-Identifier: MIT
/// Functions that inspect files: their contents, and whether the output of a run is right.
#pragma once

#include <nanobind/nanobind.h>

namespace pointsweep {

/// Adds the functions summarize, statistics and verify to the module.
void bind_checks(nanobind::module_& module);

}  // namespace pointsweep
