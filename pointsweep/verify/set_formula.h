// SPDX-License-Identifier: MIT
/// The formulas of set and where.
#pragma once

#include <memory>

#include "pointsweep/verify/stage_formula.h"

namespace pointsweep {

class SetAttribute;
class Where;

std::unique_ptr<StageFormula> set_formula_of(const SetAttribute& op);
/// Of what it makes, selection_attribute().
std::unique_ptr<StageFormula> condition_formula_of(const Where& op);

}  // namespace pointsweep
