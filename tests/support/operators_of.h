// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "pointsweep/operators/chain_stage.h"

namespace pointsweep {

/// The operators of a chain that has nothing else.
inline std::vector<std::shared_ptr<const Operator>> operators_of(const std::vector<ChainStage>& stages) {
  std::vector<std::shared_ptr<const Operator>> operators;
  for (const ChainStage& stage : stages) operators.push_back(std::get<std::shared_ptr<const Operator>>(stage));
  return operators;
}

}  // namespace pointsweep
