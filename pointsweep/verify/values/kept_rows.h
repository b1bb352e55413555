// SPDX-License-Identifier: MIT
/// The rows of an input that a run has kept, found without code of the engine.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/verify/rows/row_source.h"

namespace pointsweep {

/// Returns whether kept_rows.cpp has a formula for the rows that an operator keeps; false for conditions on each row,
/// which have a StageFormula.
bool has_kept_formula(const Operator& op);

/// Returns the selection of the rows whose flag is true.
RowSelection selection_of(std::vector<bool> kept);

/// Returns the cloud with the rows that all `operators`, which drop rows, keep. Conditions are evaluated row by row;
/// `unique`, `voxel` and `poisson` sort points in memory. If `memory_bytes` is too small for all points, the cloud is
/// read several times, for a part of the points each time. Further memory: up to three bits for each row, for `sample`
/// 16 bytes for each point of its option `number`, and for `poisson` an index of the kept points. Throws UsageError for
/// an operator whose rows cannot be checked.
InputCloud with_kept_rows(const InputCloud& cloud, const std::vector<StageOperator>& operators,
                          std::uint64_t memory_bytes, const PhaseProgress& progress);

}  // namespace pointsweep
