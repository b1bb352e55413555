// SPDX-License-Identifier: MIT
/// Formulas of the operators that connect points: whole graphs in memory.
#pragma once

#include <vector>

#include "pointsweep/verify/values/cloud_formula.h"

namespace pointsweep {

std::vector<NamedCloudFormula> graph_formulas();

}  // namespace pointsweep
