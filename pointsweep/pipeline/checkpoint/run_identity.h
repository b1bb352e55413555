// SPDX-License-Identifier: MIT
/// The identity of a run: all facts on which its output or its checkpoints depend.
#pragma once

#include <string>

#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// Returns lines of text: the version of pointsweep and of its checkpoints, inputs (with size and time), outputs,
/// options that change outputs, the pipeline with every option of every stage, passes, and the fields that are kept.
/// Throws Error if an input is not a file, since changes of it could not be detected.
std::string run_identity(const InputCloud& cloud, const ChainPlan& plan, const Outputs& outputs,
                         const EngineOptions& options);

/// Throws Error, which names the first different line, if `checkpoint`, an identity from `folder`, differs from `now`.
void require_same_run(const std::string& checkpoint, const std::string& now, const std::filesystem::path& folder);

}  // namespace pointsweep
