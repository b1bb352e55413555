// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "pointsweep/operators/chain_stage.h"

namespace pointsweep {

/// The operators of a chain that has nothing else; in place of a composite its parts.
inline std::vector<std::shared_ptr<const Operator>> operators_of(const std::vector<ChainStage>& stages) {
  std::vector<std::shared_ptr<const Operator>> operators;
  for (const ChainStage& stage : stages) {
    const auto& op = std::get<std::shared_ptr<const Operator>>(stage);
    const auto parts = op->parts();
    operators.insert(operators.end(), parts.begin(), parts.end());
    if (parts.empty()) operators.push_back(op);
  }
  return operators;
}

}  // namespace pointsweep
