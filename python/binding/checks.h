// SPDX-License-Identifier: MIT
/// Looks at files: what is in them, and whether a run has written what it should.
#pragma once

#include <nanobind/nanobind.h>

namespace pointsweep {

void bind_checks(nanobind::module_& module);

}  // namespace pointsweep
