// SPDX-License-Identifier: MIT
/// The results of a pass, row by row, and the part of them that the next pass gets.
#pragma once

#include <cstddef>
#include <memory>

#include "pointsweep/pipeline/rows/updated_cloud.h"
#include "pointsweep/pipeline/run/run_state.h"

namespace pointsweep {

/// A place for the results of pass `p`; with those that a checkpoint has kept.
std::unique_ptr<RowStore> results_of_pass(const RunState& run, std::size_t p);

/// The results of pass `p` by row, in the order of the rows. A pass over rows makes them now.
MadeRows made_by_pass(RunState& run, std::size_t p);

/// Returns how the rows that came into pass `p` become the rows that it leaves.
RowUpdate update_after(const ChainPlan& plan, std::size_t p);

}  // namespace pointsweep
