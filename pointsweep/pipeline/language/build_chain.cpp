// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/language/build_chain.h"

#include "pointsweep/chain.h"
#include "pointsweep/cloud.h"
#include "pointsweep/fail.h"
#include "pointsweep/pipeline/language/length_units.h"
#include "pointsweep/pipeline/language/option_text.h"
#include "pointsweep/pipeline/language/parse.h"
#include "pointsweep/pipeline/plan/kept_fields.h"

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

/// The stage of a pipeline that a name and options stand for.
StageText stage_text(const std::string& name, const Options& options) {
  StageText stage{name, {}, name};
  for (const Option& option : options) stage.options.push_back({option.name, text_of_value(option.value), name});
  return stage;
}

}  // namespace

Chain build_chain(const std::vector<StageText>& stages, Facts facts) {
  const NeighborhoodDeclaration& knn = neighborhood_declaration();
  for (const StageText& stage : stages)
    if (stage.name != knn.name) find_operator(stage);  // an unknown one is worse than a wrong option
  Chain chain;
  const bool has_knn = !stages.empty() && stages.front().name == knn.name;
  if (has_knn) chain.neighborhood = make_neighborhood(read_options(knn.options, stages.front()));
  append_to(chain, {stages.begin() + (has_knn ? 1 : 0), stages.end()}, std::move(facts));
  return chain;
}

void append_to(Chain& chain, const std::vector<StageText>& stages, Facts facts) {
  for (const Attribute& a : made_by(chain)) facts.made.insert(a.name);
  facts.neighborhood = chain.neighborhood;
  for (const ChainStage& stage : chain.stages) note_neighborhood(stage, facts);
  for (const StageText& stage : stages) {
    if (stage.name == neighborhood_declaration().name)
      fail_usage("{}: knn comes once and first; for other neighbourhoods from here on write {}.", stage.place,
                 to_text(std::vector<StageText>{{"reneighbor", stage.options, ""}}));
    const OperatorDeclaration& declaration = find_operator(stage);
    const std::vector<OptionDeclaration> options = in_unit(declaration.options, facts.metres_per_unit);
    chain.stages.push_back(make_stage(declaration, read_options(options, stage), facts));
    for (const Attribute& a : contract_of(chain.stages.back()).makes) facts.made.insert(a.name);
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

Chain parse_chain(std::string_view pipeline, const Cloud& cloud) {
  return build_chain(parse_pipeline(pipeline), facts_of(cloud.inputs()));
}

void append_stages(Chain& chain, std::string_view pipeline, const Cloud& cloud) {
  append_to(chain, parse_pipeline(pipeline), facts_of(cloud.inputs()));
}

void append_stage(Chain& chain, const std::string& name, const Options& options, const Cloud& cloud) {
  append_to(chain, {stage_text(name, options)}, facts_of(cloud.inputs()));
}

}  // namespace pointsweep
