// SPDX-License-Identifier: MIT
/// Pictures of clouds, as functions of the module.
#pragma once

#include <nanobind/nanobind.h>

namespace pointsweep {

/// Adds the function render to the module.
void bind_pictures(nanobind::module_& module);

}  // namespace pointsweep
