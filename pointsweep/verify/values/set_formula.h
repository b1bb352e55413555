// SPDX-License-Identifier: MIT
/// The formulas of set and where.
#pragma once

#include <vector>

#include "pointsweep/verify/values/stage_formula.h"

namespace pointsweep {

/// The formulas of set() and of `where`, which makes selection_attribute().
std::vector<NamedFormula> assignment_formulas();

}  // namespace pointsweep
