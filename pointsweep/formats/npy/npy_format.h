// SPDX-License-Identifier: MIT
/// NumPy arrays as the list of formats has them.
#pragma once

#include "pointsweep/formats/format.h"

namespace pointsweep {

extern const Format kNpyFormat;        ///< neighbours and distances
extern const Format kNpyPointsFormat;  ///< points, as input only

}  // namespace pointsweep
