// SPDX-License-Identifier: MIT
/// The checkpoints around the phases of a run that can be resumed; in any other run, nothing.
#pragma once

#include "pointsweep/pipeline/run/phases.h"

namespace pointsweep {

/// Finds what an earlier process has left of this run. Throws UsageError for a request that cannot be resumed, Error if
/// the folder holds another run.
void open_checkpoints(RunState& run);

/// Before the first pass: the rows, the selection and the values with which it begins.
void restore_rows(RunState& run);

/// Returns whether an earlier process has completed the phase. The results of a complete order and sweep are restored
/// with the results of the pass; an order whose sweep is not complete restores its stream itself.
bool is_done(const RunState& run, const Phase& phase);

/// Saves what the phase has left.
void checkpoint_after(RunState& run, const Phase& phase);

}  // namespace pointsweep
