// SPDX-License-Identifier: MIT
/// E57 as the list of formats has it.
#pragma once

#include "pointsweep/formats/format.h"

namespace pointsweep {

extern const Format kE57Format;

}  // namespace pointsweep
