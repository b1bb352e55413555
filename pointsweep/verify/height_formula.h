// SPDX-License-Identifier: MIT
/// The formula of heights above the ground.
#pragma once

#include <memory>

#include "pointsweep/verify/cloud_formula.h"

namespace pointsweep {

class Height;

std::unique_ptr<CloudFormula> height_formula_of(const Height& op);

}  // namespace pointsweep
