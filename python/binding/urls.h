// SPDX-License-Identifier: MIT
/// Functions of the module about URLs and the objects that they name.
#pragma once

#include <nanobind/nanobind.h>

namespace pointsweep {

/// Adds the functions reads_urls, known_place, object_state, get_object, put_object, list_objects and remove_object.
void bind_urls(nanobind::module_& module);

}  // namespace pointsweep
