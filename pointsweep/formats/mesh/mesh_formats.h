// SPDX-License-Identifier: MIT
/// OFF and OBJ as the list of formats has them.
#pragma once

#include "pointsweep/formats/format.h"

namespace pointsweep {

extern const Format kOffFormat, kObjFormat;

}  // namespace pointsweep
