// SPDX-License-Identifier: MIT
/// The operators that run in a pass, one for each kind.
#pragma once

#include <memory>
#include <string>
#include <variant>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/operator.h"
#include "pointsweep/operators/connect_operator.h"

namespace pointsweep {

/// What the Resort becomes that decides the order of the output: the position of the point at that place of the chain is
/// kept, as stream_position_attribute().
struct NotePosition {};

using StageOperator =
    std::variant<std::shared_ptr<const LocalOperator>, std::shared_ptr<const SelectOperator>,
                 std::shared_ptr<const InOrderOperator>, std::shared_ptr<const ConnectOperator>, NotePosition>;

/// The position that a point had at the last Resort of a chain.
Attribute stream_position_attribute();

/// Null for NotePosition.
const Operator* operator_of(const StageOperator& stage);
std::string name_of(const StageOperator& stage);
Contract contract_of(const StageOperator& stage);
/// The same stage for a cloud with the fields of `input`, after stages that make `made`.
StageOperator bound(const StageOperator& stage, const Schema& input, std::span<const Attribute> made);

/// Returns whether the stage leaves out rows.
bool drops_rows(const StageOperator& stage);
/// Returns whether the stage reads only the point itself: no neighbour, and no other point in an order.
bool is_pointwise(const StageOperator& stage);

/// Fills the columns of a batch. What a stage in order or a connecting one makes is not known batch by batch: such a
/// stage leaves the columns unchanged.
void apply(const StageOperator& stage, const Neighborhoods& in, Columns& out);

}  // namespace pointsweep
