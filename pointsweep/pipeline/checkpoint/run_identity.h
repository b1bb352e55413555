// SPDX-License-Identifier: MIT
/// The identity of a run: all that its output or its checkpoints depend on.
#pragma once

#include <string>

#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// A line for each thing: the build, inputs (with size and time), outputs, options of the run that outputs depend on,
/// the pipeline with every option of every stage, passes. Throws Error where an input is not a file, because changes of
/// it would not be noticed.
std::string run_identity(const InputCloud& cloud, const ChainPlan& plan, const Outputs& outputs,
                         const EngineOptions& options);

/// Throws Error naming the first line in which the run whose checkpoint is in `folder` was another.
void require_same_run(const std::string& checkpoint, const std::string& now, const std::filesystem::path& folder);

}  // namespace pointsweep
