// SPDX-License-Identifier: MIT
/// Formulas of the operators on surfaces, their shape and their normals.
#pragma once

#include <vector>

#include "pointsweep/verify/values/stage_formula.h"

namespace pointsweep {

std::vector<NamedFormula> shape_formulas();

}  // namespace pointsweep
