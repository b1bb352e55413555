// SPDX-License-Identifier: MIT
/// PLY as the list of formats has it.
#pragma once

#include "pointsweep/formats/format.h"

namespace pointsweep {

extern const Format kPlyFormat;

}  // namespace pointsweep
