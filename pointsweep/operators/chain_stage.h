// SPDX-License-Identifier: MIT
/// An entry of a chain: an operator, or an instruction about neighbourhoods or order.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "pointsweep/operators/operator.h"
#include "pointsweep/operators/update_operators.h"

namespace pointsweep {

using ChainStage = std::variant<std::shared_ptr<const Operator>, Reneighbor, Resort>;

/// Null for Reneighbor and Resort.
inline const Operator* operator_of(const ChainStage& stage) {
  const auto* op = std::get_if<std::shared_ptr<const Operator>>(&stage);
  return op != nullptr ? op->get() : nullptr;
}

/// What its operator reads and makes; nothing for Reneighbor and Resort.
inline Contract contract_of(const ChainStage& stage) {
  const Operator* op = operator_of(stage);
  return op != nullptr ? op->contract() : Contract();
}

/// As pipelines call it.
inline std::string name_of(const ChainStage& stage) {
  const Operator* op = operator_of(stage);
  return op != nullptr ? op->name() : std::holds_alternative<Reneighbor>(stage) ? "reneighbor" : "resort";
}

/// All that tells it from other stages of its name.
inline Options options_of(const ChainStage& stage) {
  if (const Operator* op = operator_of(stage)) return op->declared_options();
  const auto* next = std::get_if<Reneighbor>(&stage);
  return next != nullptr && next->neighborhood ? next->neighborhood->options() : Options();
}

}  // namespace pointsweep
