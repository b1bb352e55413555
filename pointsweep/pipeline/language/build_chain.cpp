// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/language/build_chain.h"

#include <algorithm>

#include "pointsweep/chain.h"
#include "pointsweep/cloud.h"
#include "pointsweep/fail.h"
#include "pointsweep/pipeline/language/length_units.h"
#include "pointsweep/pipeline/plan/kept_fields.h"
#include "pointsweep/points/neighborhood_options.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {
namespace {

std::vector<Attribute> made_by(const Chain& chain) {
  std::vector<Attribute> made;
  for (const ChainStage& stage : chain.stages)
    for (const Attribute& a : contract_of(stage).makes) made.push_back(a);
  return made;
}

void note_neighborhood(const ChainStage& stage, Facts& facts) {
  const auto* next = std::get_if<Reneighbor>(&stage);
  if (next != nullptr && next->neighborhood) facts.neighborhood = *next->neighborhood;
}

StageText stage_text(const std::string& name, const Options& options) {
  StageText stage{name, {}, name};
  for (const Option& option : options) stage.options.push_back({option.name, text_of_value(option.value), name});
  return stage;
}

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

Chain build_chain(const std::vector<StageText>& stages, Facts facts) {
  const NeighborhoodDeclaration& knn = neighborhood_declaration();
  for (const StageText& stage : stages)
    if (stage.name != knn.name) find_operator(stage);  // an unknown stage is reported before a wrong option
  Chain chain;
  const bool has_knn = !stages.empty() && stages.front().name == knn.name;
  if (has_knn) chain.neighborhood = make_neighborhood(read_options(knn.options, stages.front()));
  append_to(chain, {stages.begin() + (has_knn ? 1 : 0), stages.end()}, std::move(facts));
  return chain;
}

void require_operators(const Chain& chain) {
  if (chain.stages.empty())
    fail_usage(
        "knn alone computes nothing; add an operator, as in knn(k=8) | normals, or leave the pipeline out to copy the "
        "points.");
}

void append_to(Chain& chain, const std::vector<StageText>& stages, Facts facts) {
  facts.neighborhood = chain.neighborhood;
  for (const ChainStage& stage : chain.stages) note_neighborhood(stage, facts);
  for (const StageText& stage : stages) {
    if (stage.name == neighborhood_declaration().name)
      fail_usage("{}: knn comes once and first; for other neighbourhoods from here on write {}.", stage.place,
                 to_text(std::vector<StageText>{{"reneighbor", stage.options, ""}}));
    const OperatorDeclaration& declaration = find_operator(stage);
    const std::vector<OptionDeclaration> options = in_unit(declaration.options, facts.metres_per_unit);
    chain.stages.push_back(declaration.make(read_options(options, stage), facts));
    note_neighborhood(chain.stages.back(), facts);
  }
}

Chain build_chain(const std::vector<StageText>& stages, const InputCloud& cloud, const std::vector<std::string>& keep,
                  const std::string& prefix) {
  return build_chain(stages, facts_of(cloud), keep, prefix);
}

Chain build_chain(const std::vector<StageText>& stages, Facts facts, const std::vector<std::string>& keep,
                  const std::string& prefix) {
  Chain chain = build_chain(stages, std::move(facts));
  chain.keep = without_prefix(keep, prefix, made_by(chain));
  return chain;
}

Chain build_chain(const std::vector<StageText>& stages, const Cloud& cloud, const std::vector<std::string>& keep,
                  const std::string& prefix) {
  return build_chain(stages, cloud.inputs(), keep, prefix);
}

Chain parse_chain(std::string_view pipeline, const Cloud& cloud) {
  return build_chain(parse_pipeline(pipeline), facts_of(cloud.inputs()));
}

void append_stages(Chain& chain, std::string_view pipeline, const Cloud& cloud) {
  append_to(chain, parse_pipeline(pipeline), facts_of(cloud.inputs()));
}

void append_stage(Chain& chain, const std::string& name, const Options& options, const Cloud& cloud) {
  append_to(chain, {stage_text(name, options)}, facts_of(cloud.inputs()));
}

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
  if (plan.chain.stages.empty()) return {"convert"};
  return canonical_stages(plan.chain, presets);
}

}  // namespace pointsweep
