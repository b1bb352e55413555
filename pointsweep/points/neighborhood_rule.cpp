// SPDX-License-Identifier: MIT
#include "pointsweep/neighborhood.h"

namespace pointsweep {

SharedRule::~SharedRule() = default;

}  // namespace pointsweep
