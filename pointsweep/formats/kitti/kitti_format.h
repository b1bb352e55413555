// SPDX-License-Identifier: MIT
/// Files without a signature as the list of formats has them.
#pragma once

#include "pointsweep/formats/format.h"

namespace pointsweep {

extern const Format kKittiFormat, kFloatXyzFormat;

}  // namespace pointsweep
