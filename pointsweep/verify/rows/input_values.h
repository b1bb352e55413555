// SPDX-License-Identifier: MIT
/// Operators with the values of the whole input that they need, for those who apply them without a run.
#pragma once

#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/operators/kinds/stage_operator.h"

namespace pointsweep {

/// Gives operators that need values of the input (Reduction::of_input) these values. Reads the cloud once for each
/// value; returns all other operators unchanged.
std::vector<StageOperator> with_input_values(std::vector<StageOperator> operators, InputCloud& cloud);

}  // namespace pointsweep
