// SPDX-License-Identifier: MIT
/// What a run notes of itself on request, for plots and pictures of it.
#pragma once

#include <filesystem>
#include <vector>

#include "pointsweep/pipeline/statistics.h"
#include "pointsweep/sweep/sweep.h"

namespace pointsweep {

/// All bins from the first to the last that holds anything; before them that of distance 0 if it does.
std::vector<DistanceBin> bins_of(const NeighborDistances& distances);

/// The states by input row as a .npy file of uint8.
void write_states(const std::vector<PointState>& states, const std::filesystem::path& path, bool overwrite);

}  // namespace pointsweep
