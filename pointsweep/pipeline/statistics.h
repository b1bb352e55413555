// SPDX-License-Identifier: MIT
/// Adds to the statistics of a run, and describes the machine for them.
#pragma once

#include <cstdint>
#include <string>

#include "pointsweep/statistics.h"

namespace pointsweep {

struct SweepPlan;
struct SweepStatistics;

/// Adds a sweep that is over to those before it.
void add_sweep(Statistics& to, const SweepPlan& plan, const SweepStatistics& sweep);

/// "Intel(R) Xeon(R) Processor, 2 cores"
std::string machine_description();
/// Largest resident set of this process so far, in bytes.
std::uint64_t peak_resident_bytes();

}  // namespace pointsweep
