// SPDX-License-Identifier: MIT
/// Values of the whole input for operators that need such values, computed without a run.
#pragma once

#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/operators/kinds/stage_operator.h"

namespace pointsweep {

/// Returns the operators with the values of the whole input that they need (Reduction::of_input). Reads the cloud once
/// for each distinct value. Operators without such values are returned unchanged.
std::vector<StageOperator> with_input_values(std::vector<StageOperator> operators, InputCloud& cloud);

}  // namespace pointsweep
