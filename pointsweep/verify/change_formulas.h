// SPDX-License-Identifier: MIT
/// Formulas of the operators that compare with another cloud.
#pragma once

#include <memory>

#include "pointsweep/verify/cloud_formula.h"

namespace pointsweep {

class DistanceTo;
class M3c2;

std::unique_ptr<CloudFormula> change_formula_of(const DistanceTo& op);
std::unique_ptr<CloudFormula> change_formula_of(const M3c2& op);

}  // namespace pointsweep
