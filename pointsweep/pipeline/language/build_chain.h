// SPDX-License-Identifier: MIT
/// Builds the chain of a pipeline from facts about its cloud (Facts), and writes chains as text.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/neighborhood.h"
#include "pointsweep/operators/kinds/chain_stage.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {

/// Appends stages to a chain. `facts`: facts about the cloud of the chain. Throws UsageError for a stage knn, which may
/// only begin a pipeline.
void append_to(Chain& chain, const std::vector<StageText>& stages, Facts facts);

/// Builds a chain like build_chain() of program/pipeline.h, for a cloud that is known by its facts or for an
/// InputCloud.
Chain build_chain(const std::vector<StageText>& stages, Facts facts, const std::vector<std::string>& keep,
                  const std::string& prefix);
Chain build_chain(const std::vector<StageText>& stages, const InputCloud& cloud,
                  const std::vector<std::string>& keep = {}, const std::string& prefix = "");

/// Returns a stage in its canonical text (canonical_stages).
std::string canonical_text(const ChainStage& stage, Presets presets);

/// Returns the neighbourhood as a stage, such as "knn(k=12)"; k is left out if it is unlimited. If the rule of the
/// neighbourhood has no options, as a rule of a user may, its meaning follows in words that parse_pipeline() does not
/// read.
std::string canonical_text(const Neighborhood& neighborhood, Presets presets);

/// Returns the canonical stages of a plan; "sort" if it has no passes, "convert" if its chain has no stages.
std::vector<std::string> canonical_stages(const ChainPlan& plan, Presets presets);

}  // namespace pointsweep
