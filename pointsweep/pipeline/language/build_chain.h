// SPDX-License-Identifier: MIT
/// From the words of a pipeline to the chain that runs, and from a chain to text.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/chain.h"
#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/neighborhood.h"
#include "pointsweep/operators/kinds/chain_stage.h"
#include "pointsweep/pipeline/language/registry.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// Throws UsageError, naming the place, for an unknown name, a value out of range, and a knn that is not the first
/// stage. Where knn says neither k nor a radius, the neighbourhood is that of Neighborhood::kOfOperators.
Chain build_chain(const std::vector<StageText>& stages, Facts facts);

/// Appends stages without knn to a chain; `facts` is about its cloud.
void append_to(Chain& chain, const std::vector<StageText>& stages, Facts facts);

/// The first, with the attributes to keep, which may be named as below.
Chain build_chain(const std::vector<StageText>& stages, Facts facts, const std::vector<std::string>& keep,
                  const std::string& prefix);

/// Builds a chain as above for a cloud, against whose attributes plan_chain() then checks it. `keep` may name made
/// attributes with the `prefix` that they have in the output, or without.
Chain build_chain(const std::vector<StageText>& stages, const InputCloud& cloud,
                  const std::vector<std::string>& keep = {}, const std::string& prefix = "");

/// Throws UsageError if the chain has no stages. The chain of the pipeline `knn(k=8)` has none.
void require_operators(const Chain& chain);

enum class Presets : bool {
  left_out,     ///< for people: "normals"
  spelled_out,  ///< says everything, whatever the presets of another version are: "normals(orient=none)"
};

/// Returns a stage as text that is equal whenever stages are equal, however they were made: from text, from JSON or by
/// a program. parse_pipeline() understands it where all operators are registered. "normals(orient=up)": name and
/// options, which come in the order of their declaration, numbers in their shortest form.
std::string canonical_text(const ChainStage& stage, Presets presets);

/// Returns the neighbourhood as a stage, such as "knn(k=12)", with k wherever a number of neighbours limits it. A rule
/// of the user's own, which has no options, is described in words, which parse_pipeline() does not read.
std::string canonical_text(const Neighborhood& neighborhood, Presets presets);

/// The neighbourhood, then the stages. A number of neighbours that is left to the operators is the one that they get.
std::vector<std::string> canonical_stages(const Chain& chain, Presets presets);

/// The canonical stages of a plan; "sort" for a plan without passes, "convert" for that of a chain without stages.
std::vector<std::string> canonical_stages(const ChainPlan& plan, Presets presets);

}  // namespace pointsweep
