// SPDX-License-Identifier: MIT
/// Functions that fill in the statistics of a run: add the counts of a sweep and its stages, and describe the machine
/// and its memory. write_states() writes a file for pictures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pointsweep/statistics.h"
#include "pointsweep/sweep/sweep.h"

namespace pointsweep {

struct SweepPlan;

/// Adds the times and the degenerate results of the stages of a plan.
void add_stages(Statistics& to, const SweepPlan& plan, const std::vector<double>& seconds,
                const std::vector<DegenerateRows>& degenerate);
/// Adds the statistics of a finished sweep.
void add_sweep(Statistics& to, const SweepPlan& plan, const SweepStatistics& sweep);

/// Returns a text like "Intel(R) Xeon(R) Processor, 2 cores".
std::string machine_description();
/// Returns the largest resident set of this process so far, in bytes.
std::uint64_t peak_resident_bytes();

/// Writes the state of each point, by input row, as a .npy file of uint8.
void write_states(const std::vector<PointState>& states, const std::filesystem::path& path, bool overwrite);

}  // namespace pointsweep
