// SPDX-License-Identifier: MIT
/// Functions of the module about point files, and clouds that it generates.
#pragma once

#include <nanobind/nanobind.h>

namespace pointsweep {

/// list_files and describe.
void bind_files(nanobind::module_& module);

}  // namespace pointsweep
