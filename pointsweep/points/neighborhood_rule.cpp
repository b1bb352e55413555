// SPDX-License-Identifier: MIT
#include "pointsweep/points/neighborhood_rule.h"

namespace pointsweep {

SharedRule::~SharedRule() = default;

}  // namespace pointsweep
