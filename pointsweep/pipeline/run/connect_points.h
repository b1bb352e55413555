// SPDX-License-Identifier: MIT
/// A sweep in which one stage emits edges, and what the components of the graph tell of each point.
#pragma once

#include <cstddef>

#include "pointsweep/pipeline/run/run_state.h"
#include "pointsweep/sweep/sweep.h"

namespace pointsweep {

/// Fills the results of pass `p` for all points that are in slabs. A sweep that is interrupted begins again.
SweepStatistics sweep_and_connect(RunState& run, std::size_t p, SweepOptions options);

}  // namespace pointsweep
