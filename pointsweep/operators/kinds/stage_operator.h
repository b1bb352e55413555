// SPDX-License-Identifier: MIT
/// The kinds of stages: the operators that run in a pass, and the entries of a chain.
#pragma once

#include <memory>
#include <string>
#include <variant>

#include "pointsweep/chain.h"
#include "pointsweep/in_order_operator.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators/kinds/connect_operator.h"

namespace pointsweep {

/// Marks the last Resort of a chain: stores the current position of each point as stream_position_attribute(), which
/// decides the order of the output.
struct NotePosition {};

/// An operator that runs in a pass.
using StageOperator =
    std::variant<std::shared_ptr<const LocalOperator>, std::shared_ptr<const SelectOperator>,
                 std::shared_ptr<const InOrderOperator>, std::shared_ptr<const ConnectOperator>, NotePosition>;

/// Returns stream_position, N×3 f64: the position that a point had at the last Resort of a chain.
Attribute stream_position_attribute();

/// Returns the operator of a stage; null for NotePosition.
const Operator* operator_of(const StageOperator& stage);
std::string name_of(const StageOperator& stage);
Contract contract_of(const StageOperator& stage);
/// Returns the stage for a cloud with the fields of `input`, after stages that make `made`.
StageOperator bound(const StageOperator& stage, const Schema& input, std::span<const Attribute> made);

/// Returns whether the stage may leave out rows.
bool drops_rows(const StageOperator& stage);
/// Returns whether the stage reads only the point itself: no neighbours, and no points in order.
bool is_pointwise(const StageOperator& stage);

/// Fills the columns of a batch. In-order and connecting stages do not work on batches: they leave the columns
/// unchanged.
void apply(const StageOperator& stage, const Neighborhoods& in, Columns& out);

/// Returns the operator of a stage; null for Drop, Reneighbor and Resort.
const Operator* operator_of(const ChainStage& stage);
/// Returns the contract of the operator of a stage; for Drop, Reneighbor and Resort an empty contract with default_k 0.
Contract contract_of(const ChainStage& stage);
/// Returns the name of a stage in pipelines.
std::string name_of(const ChainStage& stage);
/// Returns all options that distinguish a stage from other stages with the same name.
Options options_of(const ChainStage& stage);
/// Returns whether a stage, or a part of a composite, may drop rows.
bool drops_rows(const ChainStage& stage);

}  // namespace pointsweep
