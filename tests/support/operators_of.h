// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <stdexcept>
#include <vector>

#include "pointsweep/operators/kinds/chain_stage.h"
#include "pointsweep/overloaded.h"

namespace pointsweep {

inline void add_operators_of(const std::vector<ChainStage>& stages, std::vector<StageOperator>& operators) {
  const auto refuse = [] { throw std::logic_error("the chain has something else than operators"); };
  for (const ChainStage& stage : stages)
    std::visit(
        overloaded{
            [&](const std::shared_ptr<const LocalOperator>& op) { operators.push_back(op); },
            [&](const std::shared_ptr<const SelectOperator>& op) { operators.push_back(op); },
            [&](const std::shared_ptr<const InOrderOperator>& op) { operators.push_back(op); },
            [&](const std::shared_ptr<const ConnectOperator>& op) { operators.push_back(op); },
            [&](const std::shared_ptr<const CompositeOperator>& op) { add_operators_of(op->parts(), operators); },
            [&](const Drop&) { refuse(); }, [&](const Reneighbor&) { refuse(); }, [&](const Resort&) { refuse(); }},
        stage);
}

/// The operators of a chain that has nothing else; in place of a composite its parts.
inline std::vector<StageOperator> operators_of(const std::vector<ChainStage>& stages) {
  std::vector<StageOperator> operators;
  add_operators_of(stages, operators);
  return operators;
}

}  // namespace pointsweep
