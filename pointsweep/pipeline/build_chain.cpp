// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/build_chain.h"

#include "pointsweep/error.h"
#include "pointsweep/pipeline/plan/kept_fields.h"

namespace pointsweep {
namespace {

std::vector<Attribute> made_by(const Chain& chain) {
  std::vector<Attribute> made;
  for (const ChainStage& stage : chain.stages)
    for (const Attribute& a : contract_of(stage).makes) made.push_back(a);
  return made;
}

}  // namespace

Chain build_chain(const std::vector<StageText>& stages, Facts facts) {
  const NeighborhoodDeclaration& knn = neighborhood_declaration();
  for (const StageText& stage : stages)
    if (stage.name != knn.name) find_operator(stage);  // an unknown one is worse than a wrong option
  Chain chain;
  for (std::size_t i = 0; i < stages.size(); ++i) {
    const StageText& stage = stages[i];
    if (stage.name != knn.name) {
      const OperatorDeclaration& declaration = find_operator(stage);
      chain.stages.push_back(make_stage(declaration, read_options(declaration.options, stage), facts));
      for (const Attribute& a : contract_of(chain.stages.back()).makes) facts.made.insert(a.name);
    } else if (i == 0) {
      chain.neighborhood = make_neighborhood(read_options(knn.options, stage));
    } else {
      fail_usage("{}: knn comes once and first; for other neighbourhoods from here on write {}.", stage.place,
                 to_text(std::vector<StageText>{{"reneighbor", stage.options, ""}}));
    }
  }
  return chain;
}

Chain build_chain(const std::vector<StageText>& stages, const Cloud& cloud, const std::vector<std::string>& keep,
                  const std::string& prefix) {
  Chain chain = build_chain(stages, Facts{.points = cloud.count()});
  chain.keep = without_prefix(keep, prefix, made_by(chain));
  return chain;
}

}  // namespace pointsweep
