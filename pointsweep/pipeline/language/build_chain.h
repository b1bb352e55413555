// SPDX-License-Identifier: MIT
/// The chain of a pipeline whose cloud is known by its facts, and the text of a chain.
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

/// Appends stages without knn to a chain; `facts` are about the cloud of the chain.
void append_to(Chain& chain, const std::vector<StageText>& stages, Facts facts);

/// Builds a chain as build_chain() of the public header, for a cloud that is known by its facts.
Chain build_chain(const std::vector<StageText>& stages, Facts facts, const std::vector<std::string>& keep,
                  const std::string& prefix);
Chain build_chain(const std::vector<StageText>& stages, const InputCloud& cloud,
                  const std::vector<std::string>& keep = {}, const std::string& prefix = "");

/// Returns a stage in its canonical text (canonical_stages).
std::string canonical_text(const ChainStage& stage, Presets presets);

/// Returns the neighbourhood as a stage, such as "knn(k=12)", with k if it is limited. A user's own rule without
/// options is described in words that parse_pipeline() does not read.
std::string canonical_text(const Neighborhood& neighborhood, Presets presets);

/// Returns the canonical stages of a plan; "sort" if it has no passes, "convert" if its chain has no stages.
std::vector<std::string> canonical_stages(const ChainPlan& plan, Presets presets);

}  // namespace pointsweep
