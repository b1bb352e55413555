// SPDX-License-Identifier: MIT
/// Observations of a run that are recorded on request, for plots and pictures.
#pragma once

#include <filesystem>
#include <vector>

#include "pointsweep/pipeline/statistics.h"
#include "pointsweep/sweep/sweep.h"

namespace pointsweep {

/// Returns all bins from the first to the last that is not empty, after the bin of distance 0 if that is not empty.
std::vector<DistanceBin> bins_of(const NeighborDistances& distances);

/// The states by input row as a .npy file of uint8.
void write_states(const std::vector<PointState>& states, const std::filesystem::path& path, bool overwrite);

}  // namespace pointsweep
