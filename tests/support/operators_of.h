// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <stdexcept>
#include <vector>

#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/overloaded.h"

namespace pointsweep {

inline void add_operators_of(const std::vector<ChainStage>& stages, const Schema& input,
                             std::vector<StageOperator>& operators) {
  const auto add = [&](const StageOperator& op) {
    std::vector<Attribute> made;
    for (const StageOperator& before : operators)
      for (const Attribute& a : contract_of(before).makes) made.push_back(a);
    operators.push_back(bound(op, input, made));
  };
  const auto refuse = [] { throw std::logic_error("the chain has something else than operators"); };
  for (const ChainStage& stage : stages)
    std::visit(overloaded{[&](const std::shared_ptr<const LocalOperator>& op) { add(op); },
                          [&](const std::shared_ptr<const SelectOperator>& op) { add(op); },
                          [&](const std::shared_ptr<const InOrderOperator>& op) { add(op); },
                          [&](const std::shared_ptr<const ConnectOperator>& op) { add(op); },
                          [&](const std::shared_ptr<const CompositeOperator>& op) {
                            add_operators_of(op->parts(), input, operators);
                          },
                          [&](const Drop&) { refuse(); }, [&](const Reneighbor&) { refuse(); },
                          [&](const Resort&) { refuse(); }},
               stage);
}

/// Returns the operators of a chain of only `stages`, for a cloud with the fields of `input`; composites are replaced
/// by their parts.
inline std::vector<StageOperator> operators_of(const std::vector<ChainStage>& stages, const Schema& input) {
  std::vector<StageOperator> operators;
  add_operators_of(stages, input, operators);
  return operators;
}

}  // namespace pointsweep
