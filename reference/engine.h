// SPDX-License-Identifier: MIT
/// The paper's own algorithm as an engine of runs.
#pragma once

namespace pointsweep {

/// Lets the runs of this program use Engine::reference.
void register_reference_engine();

}  // namespace pointsweep
