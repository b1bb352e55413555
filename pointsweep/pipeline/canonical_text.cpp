// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/canonical_text.h"

#include <algorithm>

#include "pointsweep/pipeline/registry.h"
#include "pointsweep/points/neighborhood_options.h"

namespace pointsweep {
namespace {

const OptionDeclaration* option_named(const std::vector<OptionDeclaration>& declared, const std::string& name) {
  const auto found = std::ranges::find(declared, name, &OptionDeclaration::name);
  return found == declared.end() ? nullptr : &*found;
}

std::string stage_text(const std::string& name, const Options& options, const std::vector<OptionDeclaration>& declared,
                       Presets presets) {
  StageText stage{name, {}, {}};
  for (const Option& option : options) {
    const OptionDeclaration* declaration = option_named(declared, option.name);
    const bool is_preset = declaration != nullptr && declaration->preset == option.value;
    if (is_preset && presets == Presets::left_out) continue;
    const bool named = declaration == nullptr || !declaration->positional;
    stage.options.push_back({named ? option.name : "", text_of_value(option.value), {}});
  }
  return to_text(std::vector<StageText>{stage});
}

/// Those of knn. k has no preset here: where it is not said, it does not limit anything.
std::vector<OptionDeclaration> neighborhood_options() {
  std::vector<OptionDeclaration> options = neighborhood_declaration().options;
  for (OptionDeclaration& option : options)
    if (option.name == "k") option.preset = {};
  return options;
}

}  // namespace

std::string canonical_text(const ChainStage& stage, Presets presets) {
  const OperatorDeclaration* declaration = declaration_of(name_of(stage));
  return stage_text(name_of(stage), options_of(stage),
                    declaration != nullptr ? declaration->options : std::vector<OptionDeclaration>(), presets);
}

std::string canonical_text(const Neighborhood& neighborhood, Presets presets) {
  std::string text =
      stage_text(neighborhood_declaration().name, options_of(neighborhood), neighborhood_options(), presets);
  if (neighborhood.rule && neighborhood.rule->options().empty()) text += " " + neighborhood.rule->meaning();
  return text;
}

std::vector<std::string> canonical_stages(const Chain& chain, Presets presets) {
  std::vector<std::string> stages = {canonical_text(chain.neighborhood, presets)};
  for (const ChainStage& stage : chain.stages) stages.push_back(canonical_text(stage, presets));
  return stages;
}

std::vector<std::string> canonical_stages(const ChainPlan& plan, Presets presets) {
  if (plan.passes.empty()) return {"sort"};
  return canonical_stages(plan.chain, presets);
}

}  // namespace pointsweep
