// SPDX-License-Identifier: MIT
/// Functions of the module that generate points on known shapes.
#pragma once

#include <nanobind/nanobind.h>

namespace pointsweep {

/// Adds the functions generate and shape_names to the module.
void bind_generate(nanobind::module_& module);

}  // namespace pointsweep
