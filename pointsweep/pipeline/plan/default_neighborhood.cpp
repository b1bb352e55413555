// SPDX-License-Identifier: MIT
#include <algorithm>
#include <string>

#include "pointsweep/chain.h"
#include "pointsweep/fail.h"
#include "pointsweep/operators/kinds/chain_stage.h"

namespace pointsweep {
namespace {

/// Sets k and the radius of a neighbourhood that leaves them to its operators (kOfOperators). Its operators are the
/// stages from `first` up to the next Reneighbor that states a neighbourhood.
void close(Neighborhood& open, const std::vector<ChainStage>& stages, std::size_t first) {
  if (open.k != Neighborhood::kOfOperators) return;
  std::size_t k = 0;
  double radius = 0;
  std::string of_radius, of_k;
  for (std::size_t s = first; s < stages.size(); ++s) {
    const auto* next = std::get_if<Reneighbor>(&stages[s]);
    if (next != nullptr && next->neighborhood) break;
    const Operator* op = operator_of(stages[s]);
    const Contract contract = op != nullptr ? op->contract() : Contract{.default_k = 0};
    if (contract.default_k == 0) continue;
    if (contract.all_within > radius)
      radius = contract.all_within, of_radius = name_of(stages[s]);
    else if (contract.all_within == 0)
      k = std::max(k, contract.default_k), of_k = name_of(stages[s]);
  }
  if (radius > 0 && k > 0)
    fail_usage(
        "'{}' needs all neighbours within {}, and '{}' looks at as many as the pipeline says; write knn(radius={}) "
        "before them.",
        of_radius, radius, of_k, radius);
  if (radius > 0) {
    open.k = Neighborhood::kUnlimited;
    open.radius = std::min(open.radius, radius);
  } else {
    open.k = k == 0 ? Contract().default_k : k;
  }
}

}  // namespace

Chain with_named_neighborhoods(Chain chain) {
  close(chain.neighborhood, chain.stages, 0);
  for (std::size_t s = 0; s < chain.stages.size(); ++s) {
    const auto* next = std::get_if<Reneighbor>(&chain.stages[s]);
    if (next == nullptr || !next->neighborhood || next->neighborhood->k != Neighborhood::kOfOperators) continue;
    Neighborhood neighborhood = *next->neighborhood;
    close(neighborhood, chain.stages, s + 1);
    chain.stages[s] = Reneighbor(neighborhood);
  }
  return chain;
}

}  // namespace pointsweep
