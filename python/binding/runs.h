// SPDX-License-Identifier: MIT
/// The functions of the module that run a chain.
#pragma once

#include <nanobind/nanobind.h>

namespace pointsweep {

/// run, neighbors and radius_neighbors.
void bind_runs(nanobind::module_& module);

}  // namespace pointsweep
