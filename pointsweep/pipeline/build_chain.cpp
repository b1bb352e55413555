// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/build_chain.h"

#include <algorithm>

#include "pointsweep/error.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/pipeline/planned_sweeps.h"

namespace pointsweep {
namespace {

double diagonal_of(Cloud& cloud) {
  const PointSource source{cloud.schema(), cloud.count(),
                           [&](std::uint64_t row, std::span<std::byte> records) { return cloud.read(row, records); }};
  const Box bounds = survey(source, std::nullopt, true).bounds;
  return bounds.diagonal();
}

bool any_needs_diagonal(const std::vector<StageText>& stages) {
  return std::any_of(stages.begin(), stages.end(), [](const StageText& stage) {
    return stage.name != neighborhood_declaration().name && find_operator(stage).needs_diagonal;
  });
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
      chain.operators.push_back(make_operator(declaration, read_options(declaration.options, stage), facts));
      for (const Attribute& a : chain.operators.back()->contract().makes) facts.made.insert(a.name);
    } else if (i == 0) {
      chain.neighborhood = make_neighborhood(read_options(knn.options, stage));
    } else {
      fail_usage("{}: knn comes once and first; for other neighbourhoods from here on write {}.", stage.place,
                 to_text(std::vector<StageText>{{"reneighbor", stage.options, ""}}));
    }
  }
  return chain;
}

Chain build_chain(const std::vector<StageText>& stages, Cloud& cloud, const std::vector<std::string>& keep) {
  Facts facts{.points = cloud.count()};
  Chain chain = build_chain(stages, facts);
  chain.keep = keep;
  plan_sweeps(chain, cloud.schema());
  if (!any_needs_diagonal(stages)) return chain;
  facts.diagonal = diagonal_of(cloud);
  chain.operators = build_chain(stages, facts).operators;
  return chain;
}

}  // namespace pointsweep
