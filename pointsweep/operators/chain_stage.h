// SPDX-License-Identifier: MIT
/// What an entry of a chain says of itself, be it an operator or an instruction.
#pragma once

#include <string>
#include <variant>

#include "pointsweep/chain.h"
#include "pointsweep/points/neighborhood_options.h"

namespace pointsweep {

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
  return next != nullptr && next->neighborhood ? options_of(*next->neighborhood) : Options();
}

}  // namespace pointsweep
