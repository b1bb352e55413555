// SPDX-License-Identifier: MIT
/// Formulas of the operators that describe the surface around a point.
#pragma once

#include <memory>

#include "pointsweep/verify/stage_formula.h"

namespace pointsweep {

/// Nothing for other operators.
std::unique_ptr<StageFormula> shape_formula_of(const Operator& op);

}  // namespace pointsweep
