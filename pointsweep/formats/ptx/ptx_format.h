// SPDX-License-Identifier: MIT
/// PTX as the list of formats has it.
#pragma once

#include "pointsweep/formats/format.h"

namespace pointsweep {

extern const Format kPtxFormat;

}  // namespace pointsweep
