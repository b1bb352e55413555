// SPDX-License-Identifier: MIT
/// When the output files of a run are opened, and what is known of their content then.
#pragma once

#include "pointsweep/pipeline/run/run_state.h"

namespace pointsweep {

/// Whether a format needs the bounds before the first record: one that stores integers, unless these integers come.
bool needs_bounds(const RunState& run);
/// Throws what keeps the outputs from being written, as far as it is known before the work.
void require_writable(const RunState& run);
/// Before the first pass. Where a select leaves out rows, only makes sure that they can be written.
void open_outputs(RunState& run);
/// The files of a run that has left out rows. `run.survey` is that of the order of the output, if it has one.
void open_late(RunState& run);

}  // namespace pointsweep
