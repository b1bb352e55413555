// SPDX-License-Identifier: MIT
/// What a pass has made, row by row, and what of it goes on.
#pragma once

#include <cstddef>
#include <memory>

#include "pointsweep/pipeline/run/run_state.h"
#include "pointsweep/pipeline/updated_cloud.h"

namespace pointsweep {

/// A place for the results of pass `p`; with those that a checkpoint has kept.
std::unique_ptr<RowStore> results_of_pass(const RunState& run, std::size_t p);

/// The results of pass `p` by row, in the order of the rows. A pass over rows makes them now.
MadeRows made_by_pass(RunState& run, std::size_t p);

/// How the rows that came into pass `p` become those that it leaves.
RowUpdate update_after(const ChainPlan& plan, std::size_t p);

}  // namespace pointsweep
