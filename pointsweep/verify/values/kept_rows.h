// SPDX-License-Identifier: MIT
/// The rows of an input that a run has kept, found without the engine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/verify/rows/row_source.h"

namespace pointsweep {

/// Selects in `cloud` what the selecting operators at the beginning of `operators` keep, and returns how many operators
/// that are. Conditions are evaluated row by row; equal points and voxels are found by sorting in memory, in as many
/// turns as `memory_bytes` asks for. A bit of memory for each row.
std::size_t select_kept_rows(InputCloud& cloud, const std::vector<StageOperator>& operators, std::uint64_t memory_bytes,
                             const PhaseProgress& progress);

/// One entry for each row that `cloud` has now. In memory are the kept points and a share of the others, in as many
/// turns as `memory_bytes` asks for; each turn reads the cloud once.
std::vector<bool> rows_of_disks(InputCloud& cloud, double radius, std::uint64_t memory_bytes,
                                const PhaseProgress& progress);

}  // namespace pointsweep
