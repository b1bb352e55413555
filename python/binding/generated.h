// SPDX-License-Identifier: MIT
/// Clouds of known geometry.
#pragma once

#include <nanobind/nanobind.h>

namespace pointsweep {

/// Adds the functions generate and shape_names to the module.
void bind_generate(nanobind::module_& module);

}  // namespace pointsweep
