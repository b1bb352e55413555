// SPDX-License-Identifier: MIT
#include "pointsweep/operators/kinds/chain_stage.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "pointsweep/overloaded.h"
#include "pointsweep/points/neighborhood_options.h"

namespace pointsweep {

const Operator* operator_of(const ChainStage& stage) {
  return std::visit(
      overloaded{[]<class Kind>(const std::shared_ptr<const Kind>& op) -> const Operator* { return op.get(); },
                 [](const Drop&) -> const Operator* { return nullptr; },
                 [](const Reneighbor&) -> const Operator* { return nullptr; },
                 [](const Resort&) -> const Operator* { return nullptr; }},
      stage);
}

Contract contract_of(const ChainStage& stage) {
  const Operator* op = operator_of(stage);
  return op != nullptr ? op->contract() : Contract{.default_k = 0};
}

std::string name_of(const ChainStage& stage) {
  return std::visit(overloaded{[]<class Kind>(const std::shared_ptr<const Kind>& op) { return op->name(); },
                               [](const Drop&) { return std::string("drop"); },
                               [](const Reneighbor&) { return std::string("reneighbor"); },
                               [](const Resort&) { return std::string("resort"); }},
                    stage);
}

Options options_of(const ChainStage& stage) {
  return std::visit(
      overloaded{[]<class Kind>(const std::shared_ptr<const Kind>& op) { return op->declared_options(); },
                 [](const Drop& drop) -> Options {
                   return {{"attributes", fmt::format("{}", fmt::join(drop.attributes, ","))}};
                 },
                 [](const Reneighbor& r) { return r.neighborhood ? options_of(*r.neighborhood) : Options(); },
                 [](const Resort&) { return Options(); }},
      stage);
}

bool drops_rows(const ChainStage& stage) {
  return std::visit(
      overloaded{[]<class Kind>(const std::shared_ptr<const Kind>& op) { return drops_rows(StageOperator(op)); },
                 [](const std::shared_ptr<const CompositeOperator>& op) {
                   return std::ranges::any_of(op->parts(), [](const ChainStage& part) { return drops_rows(part); });
                 },
                 [](const Drop&) { return false; }, [](const Reneighbor&) { return false; },
                 [](const Resort&) { return false; }},
      stage);
}

}  // namespace pointsweep
