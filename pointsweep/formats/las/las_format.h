// SPDX-License-Identifier: MIT
/// LAS and LAZ as the list of formats has them.
#pragma once

#include "pointsweep/formats/format.h"

namespace pointsweep {

extern const Format kLasFormat, kLazFormat;

}  // namespace pointsweep
