// SPDX-License-Identifier: MIT
/// Clouds of known geometry.
#pragma once

#include <nanobind/nanobind.h>

namespace pointsweep {

/// generate and shape_names.
void bind_generate(nanobind::module_& module);

}  // namespace pointsweep
