// SPDX-License-Identifier: MIT
/// The formula of set.
#pragma once

#include <memory>

#include "pointsweep/verify/stage_formula.h"

namespace pointsweep {

class SetAttribute;

std::unique_ptr<StageFormula> set_formula_of(const SetAttribute& op);

}  // namespace pointsweep
