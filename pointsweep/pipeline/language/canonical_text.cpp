// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/language/canonical_text.h"

#include <algorithm>

#include "pointsweep/pipeline/language/registry.h"
#include "pointsweep/pipeline/plan/default_neighborhood.h"
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

}  // namespace

std::string canonical_text(const ChainStage& stage, Presets presets) {
  const OperatorDeclaration* declaration = declaration_of(name_of(stage));
  return stage_text(name_of(stage), options_of(stage),
                    declaration != nullptr ? declaration->options : std::vector<OptionDeclaration>(), presets);
}

std::string canonical_text(const Neighborhood& neighborhood, Presets presets) {
  const NeighborhoodDeclaration& knn = neighborhood_declaration();
  std::string text = stage_text(knn.name, options_of(neighborhood), knn.options, presets);
  if (neighborhood.rule && neighborhood.rule->options().empty()) text += " " + neighborhood.rule->meaning();
  return text;
}

std::vector<std::string> canonical_stages(const Chain& open, Presets presets) {
  const bool is_knn_alone = open.stages.empty();
  const Chain chain = is_knn_alone ? open : with_named_neighborhoods(open);
  std::vector<std::string> stages = {canonical_text(chain.neighborhood, presets)};
  for (const ChainStage& stage : chain.stages) stages.push_back(canonical_text(stage, presets));
  return stages;
}

std::vector<std::string> canonical_stages(const ChainPlan& plan, Presets presets) {
  if (plan.passes.empty()) return {"sort"};
  return canonical_stages(plan.chain, presets);
}

}  // namespace pointsweep
