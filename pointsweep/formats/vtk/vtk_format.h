// SPDX-License-Identifier: MIT
/// VTK as the list of formats has it.
#pragma once

#include "pointsweep/formats/format.h"

namespace pointsweep {

extern const Format kVtkFormat;

}  // namespace pointsweep
