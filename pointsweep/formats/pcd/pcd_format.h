// SPDX-License-Identifier: MIT
/// PCD as the list of formats has it.
#pragma once

#include "pointsweep/formats/format.h"

namespace pointsweep {

extern const Format kPcdFormat;

}  // namespace pointsweep
