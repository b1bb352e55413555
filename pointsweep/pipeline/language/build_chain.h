// SPDX-License-Identifier: MIT
/// Builds the chain of a pipeline, and the text of a chain.
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

/// Throws UsageError with the place for an unknown name, a value out of range, and a knn that is not the first stage.
/// If knn states neither k nor a radius, the neighbourhood is Neighborhood::kOfOperators.
Chain build_chain(const std::vector<StageText>& stages, Facts facts);

/// Appends stages without knn to a chain; `facts` is about its cloud.
void append_to(Chain& chain, const std::vector<StageText>& stages, Facts facts);

/// Builds a chain as above, and states the attributes to keep. The overload below describes their names.
Chain build_chain(const std::vector<StageText>& stages, Facts facts, const std::vector<std::string>& keep,
                  const std::string& prefix);

/// Builds a chain as above for a cloud, against whose attributes plan_chain() then checks it. `keep` may name made
/// attributes with the `prefix` that they have in the output, or without.
Chain build_chain(const std::vector<StageText>& stages, const InputCloud& cloud,
                  const std::vector<std::string>& keep = {}, const std::string& prefix = "");

/// Throws UsageError if the chain has no stages. The chain of the pipeline `knn(k=8)` has none.
void require_operators(const Chain& chain);

enum class Presets : bool {
  left_out,     ///< omitted, for messages: "normals"
  spelled_out,  ///< written out, independent of the presets of other versions: "normals(orient=none)"
};

/// Returns a text that is equal for equal stages, made from text, from JSON or by a program. parse_pipeline() reads it
/// if all operators are registered. "normals(orient=up)": name and options, in the order of their declaration, with
/// numbers in their shortest form.
std::string canonical_text(const ChainStage& stage, Presets presets);

/// Returns the neighbourhood as a stage, such as "knn(k=12)", with k if it is limited. A user's own rule without
/// options is described in words that parse_pipeline() does not read.
std::string canonical_text(const Neighborhood& neighborhood, Presets presets);

/// Returns the neighbourhood and the stages. A default number of neighbours is written out.
std::vector<std::string> canonical_stages(const Chain& chain, Presets presets);

/// The canonical stages of a plan; "sort" for a plan without passes, "convert" for that of a chain without stages.
std::vector<std::string> canonical_stages(const ChainPlan& plan, Presets presets);

}  // namespace pointsweep
