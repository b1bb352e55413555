// SPDX-License-Identifier: MIT
/// QSplat as the list of formats has it.
#pragma once

#include "pointsweep/formats/format.h"

namespace pointsweep {

extern const Format kQsplatFormat;

}  // namespace pointsweep
