// SPDX-License-Identifier: MIT
/// Tasks of a run that many processes perform.
#pragma once

#include <nanobind/nanobind.h>

namespace pointsweep {

void bind_parts(nanobind::module_& module);

}  // namespace pointsweep
