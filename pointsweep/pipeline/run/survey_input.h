// SPDX-License-Identifier: MIT
/// Looking at points before they are put in order.
#pragma once

#include "pointsweep/pipeline/run/run_state.h"

namespace pointsweep {

/// Surveys `run.source`. `exact`: all of its points, else as many as it takes.
void survey_source(RunState& run, bool exact);

}  // namespace pointsweep
