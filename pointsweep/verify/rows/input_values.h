// SPDX-License-Identifier: MIT
/// Values of the whole input for operators that need such values, computed without a run.
#pragma once

#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/operators/kinds/stage_operator.h"

namespace pointsweep {

/// Gives operators that need values of the input (Reduction::of_input) these values. Reads the cloud once for each
/// value; returns all other operators unchanged.
std::vector<StageOperator> with_input_values(std::vector<StageOperator> operators, InputCloud& cloud);

}  // namespace pointsweep
