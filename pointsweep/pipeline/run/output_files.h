// SPDX-License-Identifier: MIT
/// When the output files of a run are opened, and what is known of their content then.
#pragma once

#include "pointsweep/pipeline/run/run_state.h"

namespace pointsweep {

/// Returns whether a format needs the bounds before the first record: a format that stores integers, unless the records
/// hold these integers already.
bool needs_bounds(const RunState& run);
/// Throws if the outputs cannot be written, as far as this is known before the work.
void require_writable(const RunState& run);
/// Before the first pass. Where a select leaves out rows, only makes sure that they can be written.
void open_outputs(RunState& run);
/// The files of a run that has left out rows. `run.survey` is that of the order of the output, if it has one.
void open_late(RunState& run);

}  // namespace pointsweep
