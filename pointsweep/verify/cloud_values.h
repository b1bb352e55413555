// SPDX-License-Identifier: MIT
/// Values of the whole cloud that stages need, computed without a run: reductions of the input, and the mean distance
/// above which points are outliers.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/verify/rows/row_source.h"
#include "pointsweep/verify/search/surroundings.h"
#include "pointsweep/verify/values/stage_formula.h"

namespace pointsweep {

/// Returns the operators with the values of the whole input that they need (Reduction::of_input). Reads the cloud once
/// for each distinct value. Operators without such values are returned unchanged.
std::vector<StageOperator> with_input_values(std::vector<StageOperator> operators, InputCloud& cloud);

/// Returns whether an operator after the first Outlier makes the mean distances again. The output then lacks the
/// distances that Outlier compared.
bool makes_distances_again(const std::vector<StageOperator>& operators);

/// Returns the threshold for the first Outlier among the operators: mean + multiplier * deviation, by the operator's
/// definition, of the finite mean distances of all points of `out`, in extended precision; NaN if no operator is an
/// Outlier, or if the output lacks its mean distances. `prefix`: prefix of the names of made attributes. Reads `out`
/// twice.
CloudThreshold outlier_threshold(RowSource& out, const std::vector<StageOperator>& operators, const std::string& prefix,
                                 const PhaseProgress& progress);

/// Returns the threshold from the mean distances of all points of the input, for an output that lacks some distances.
/// The operators themselves compute the distances. Throws NotTold if the check cannot be made.
CloudThreshold outlier_threshold_of_all(InputCloud& in, const std::vector<StageOperator>& operators,
                                        const SharedRule& rule, const NeighborRule& neighborhood,
                                        std::uint64_t memory_bytes);

}  // namespace pointsweep
