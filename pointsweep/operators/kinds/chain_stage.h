// SPDX-License-Identifier: MIT
/// Name, contract and options of an entry of a chain: an operator, Drop, Reneighbor or Resort.
#pragma once

#include <string>

#include "pointsweep/chain.h"
#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators/kinds/connect_operator.h"
#include "pointsweep/operators/kinds/stage_operator.h"

namespace pointsweep {

/// Returns null for Drop, Reneighbor and Resort.
const Operator* operator_of(const ChainStage& stage);
/// Returns the contract of its operator; an empty one without neighbours for Reneighbor, Resort and Drop.
Contract contract_of(const ChainStage& stage);
/// Returns its name in pipelines.
std::string name_of(const ChainStage& stage);
/// Returns all options that distinguish it from other stages of its name.
Options options_of(const ChainStage& stage);
/// Returns whether the stage, or a stage for which it stands, drops rows.
bool drops_rows(const ChainStage& stage);

}  // namespace pointsweep
