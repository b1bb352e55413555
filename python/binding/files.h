// SPDX-License-Identifier: MIT
/// Functions of the module that list point files and read their headers.
#pragma once

#include <nanobind/nanobind.h>

namespace pointsweep {

/// Adds the functions list_files and describe to the module.
void bind_files(nanobind::module_& module);

}  // namespace pointsweep
