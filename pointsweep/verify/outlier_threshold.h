// SPDX-License-Identifier: MIT
/// The mean distance from which on points of an output are outliers.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/reader.h"
#include "pointsweep/verify/rows/row_source.h"
#include "pointsweep/verify/search/surroundings.h"
#include "pointsweep/verify/values/stage_formula.h"

namespace pointsweep {

/// Returns whether an operator after the first Outlier makes the mean distances again, so that the output does not have
/// those that it compared.
bool makes_distances_again(const std::vector<StageOperator>& operators);

/// mean + multiplier * deviation, by the operator's definition, of the finite mean distances of all points of `out`, in
/// extended precision, for the first Outlier among the operators. `prefix`: of the names of made attributes. NaN if
/// there is none, or if the output has not its mean distances. Reads it twice.
CloudThreshold outlier_threshold(Reader& out, const std::vector<StageOperator>& operators, const std::string& prefix,
                                 const PhaseProgress& progress);

/// Returns the threshold of the mean distances of all points of the input, for an output that has not all. The
/// operators themselves make these distances. Throws NotTold.
CloudThreshold outlier_threshold_of_all(InputCloud& in, const std::vector<StageOperator>& operators,
                                        const SharedRule& rule, const NeighborRule& neighborhood,
                                        std::uint64_t memory_bytes);

}  // namespace pointsweep
