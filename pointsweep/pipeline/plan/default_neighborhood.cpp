// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/plan/default_neighborhood.h"

#include <algorithm>

#include "pointsweep/operators/kinds/chain_stage.h"

namespace pointsweep {
namespace {

/// Returns the largest default number of neighbours among the operators that use the neighbourhood of stage `first`.
std::size_t wanted_k(const std::vector<ChainStage>& stages, std::size_t first) {
  std::size_t k = 0;
  for (std::size_t s = first; s < stages.size(); ++s) {
    const auto* next = std::get_if<Reneighbor>(&stages[s]);
    if (next != nullptr && next->neighborhood) break;
    if (const Operator* op = operator_of(stages[s])) k = std::max(k, op->contract().default_k);
  }
  return k == 0 ? Contract().default_k : k;
}

}  // namespace

Chain with_named_neighborhoods(Chain chain) {
  const auto is_open = [](const Neighborhood& n) { return n.k == Neighborhood::kOfOperators; };
  if (is_open(chain.neighborhood)) chain.neighborhood.k = wanted_k(chain.stages, 0);
  for (std::size_t s = 0; s < chain.stages.size(); ++s) {
    const auto* next = std::get_if<Reneighbor>(&chain.stages[s]);
    if (next == nullptr || !next->neighborhood || !is_open(*next->neighborhood)) continue;
    Neighborhood neighborhood = *next->neighborhood;
    neighborhood.k = wanted_k(chain.stages, s + 1);
    chain.stages[s] = Reneighbor(neighborhood);
  }
  return chain;
}

}  // namespace pointsweep
