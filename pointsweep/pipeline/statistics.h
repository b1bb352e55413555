// SPDX-License-Identifier: MIT
/// Functions that fill in the statistics of a run: add the counts of a sweep, describe the machine, and store what was
/// requested for plots and pictures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pointsweep/statistics.h"
#include "pointsweep/sweep/sweep.h"

namespace pointsweep {

struct SweepPlan;

/// Adds the statistics of a finished sweep.
void add_sweep(Statistics& to, const SweepPlan& plan, const SweepStatistics& sweep);

/// Returns a text like "Intel(R) Xeon(R) Processor, 2 cores".
std::string machine_description();
/// Returns the largest resident set of this process so far, in bytes.
std::uint64_t peak_resident_bytes();

/// Returns the bin of distance 0 if it has counts, and all bins from the first to the last of the others that have
/// counts.
std::vector<DistanceBin> bins_of(const NeighborDistances& distances);

/// Writes the state of each point, by input row, as a .npy file of uint8.
void write_states(const std::vector<PointState>& states, const std::filesystem::path& path, bool overwrite);

}  // namespace pointsweep
