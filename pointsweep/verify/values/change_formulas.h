// SPDX-License-Identifier: MIT
/// Formulas of the operators that compare with another cloud.
#pragma once

#include <vector>

#include "pointsweep/verify/values/cloud_formula.h"

namespace pointsweep {

std::vector<NamedCloudFormula> change_formulas();

}  // namespace pointsweep
