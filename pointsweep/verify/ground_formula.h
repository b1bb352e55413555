// SPDX-License-Identifier: MIT
/// The formula of the classes that the ground filter gives.
#pragma once

#include <memory>

#include "pointsweep/verify/cloud_formula.h"

namespace pointsweep {

class Ground;

std::unique_ptr<CloudFormula> ground_formula_of(const Ground& op);

}  // namespace pointsweep
