// SPDX-License-Identifier: MIT
/// Stages as text that is equal whenever they are equal, however they were made: from text, from JSON or by a program.
/// parse_pipeline() understands it where all operators are registered.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/neighborhood.h"
#include "pointsweep/operators/kinds/chain_stage.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

enum class Presets : bool {
  left_out,     ///< for people: "normals"
  spelled_out,  ///< says everything, whatever the presets of another version are: "normals(orient=none)"
};

/// "normals(orient=up)": name and options, which come in the order of their declaration, numbers in their shortest
/// form.
std::string canonical_text(const ChainStage& stage, Presets presets);
/// "knn(k=12)"; k is always there if it limits anything. A rule that names no options is told by its meaning, which is
/// no text for parse_pipeline().
std::string canonical_text(const Neighborhood& neighborhood, Presets presets);
/// The neighbourhood, then the stages. A number of neighbours that is left to the operators is the one that they get.
std::vector<std::string> canonical_stages(const Chain& chain, Presets presets);
/// The canonical stages of a plan; "sort" for a plan without passes.
std::vector<std::string> canonical_stages(const ChainPlan& plan, Presets presets);

}  // namespace pointsweep
