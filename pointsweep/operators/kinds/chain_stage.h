// SPDX-License-Identifier: MIT
/// Name, contract and options of an entry of a chain: an operator, Drop, Reneighbor or Resort.
#pragma once

#include <string>

#include "pointsweep/chain.h"
#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators/kinds/connect_operator.h"
#include "pointsweep/operators/kinds/stage_operator.h"

namespace pointsweep {

/// Returns the operator of a stage; null for Drop, Reneighbor and Resort.
const Operator* operator_of(const ChainStage& stage);
/// Returns the contract of the operator of a stage; for Drop, Reneighbor and Resort an empty contract with default_k 0.
Contract contract_of(const ChainStage& stage);
/// Returns the name of a stage in pipelines.
std::string name_of(const ChainStage& stage);
/// Returns all options that distinguish a stage from other stages with the same name.
Options options_of(const ChainStage& stage);
/// Returns whether a stage, or a part of a composite, drops rows.
bool drops_rows(const ChainStage& stage);

}  // namespace pointsweep
