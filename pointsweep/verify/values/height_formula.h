// SPDX-License-Identifier: MIT
/// The formula of heights above the ground.
#pragma once

#include "pointsweep/verify/values/cloud_formula.h"

namespace pointsweep {

NamedCloudFormula height_formula();

}  // namespace pointsweep
