// SPDX-License-Identifier: MIT
/// What a run is, as far as its output or its checkpoints depend on it.
#pragma once

#include <string>

#include "pointsweep/pipeline/pipeline.h"
#include "pointsweep/pipeline/planned_sweeps.h"

namespace pointsweep {

/// A line for each thing: the build, inputs (with size and time), outputs, order, axis, the pipeline, sweeps. Threads
/// and memory are not among them. `stages`: canonical_stages() with all presets, so that every option of every operator
/// is in it, or {"sort"}. Throws Error where an input is not a file, because changes of it would not be noticed.
std::string run_identity(const Cloud& cloud, const std::vector<std::string>& stages, const PlannedSweeps& planned,
                         const Outputs& outputs, const RunOptions& options);

/// Throws Error naming the first line in which the run whose checkpoint is in `folder` was another.
void require_same_run(const std::string& checkpoint, const std::string& now, const std::filesystem::path& folder);

}  // namespace pointsweep
