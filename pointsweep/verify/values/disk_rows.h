// SPDX-License-Identifier: MIT
/// The rows that poisson keeps, by its definition: one point after another, in the order of their hashes.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/verify/rows/row_source.h"

namespace pointsweep {

/// One entry for each row that `cloud` has now. In memory are the kept points and a share of the others, in as many
/// turns as `memory_bytes` asks for; each turn reads the cloud once.
std::vector<bool> rows_of_disks(InputCloud& cloud, double radius, std::uint64_t memory_bytes,
                                const PhaseProgress& progress);

}  // namespace pointsweep
