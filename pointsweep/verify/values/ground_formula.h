// SPDX-License-Identifier: MIT
/// The formula of the classes that the ground filter gives.
#pragma once

#include "pointsweep/verify/values/cloud_formula.h"

namespace pointsweep {

NamedCloudFormula ground_formula();

}  // namespace pointsweep
