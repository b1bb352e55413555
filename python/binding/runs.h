// SPDX-License-Identifier: MIT
/// The functions of the module that run a chain.
#pragma once

#include <nanobind/nanobind.h>

namespace pointsweep {

/// Adds the functions run, run_to_blocks, plan and canonical_stages, and the four searches for neighbours, to the
/// module.
void bind_runs(nanobind::module_& module);

}  // namespace pointsweep
