// SPDX-License-Identifier: MIT
#include "pointsweep/operators/kinds/stage_operator.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>

#include "pointsweep/overloaded.h"
#include "pointsweep/points/degenerate_points.h"
#include "pointsweep/points/neighborhood_options.h"
#include "pointsweep/program/declaration.h"

namespace pointsweep {
namespace {

void note_positions(const Neighborhoods& in, Columns& out) {
  const auto position = out.column<std::array<double, 3>>(0);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Vec3 p = in.position(i);
    position[i] = {p.x, p.y, p.z};
  }
}

}  // namespace

void Columns::mark_degenerate(std::size_t i) {
  assert(i < size_);
  degenerate_->mark(i);
}

Attribute stream_position_attribute() {
  return {"stream_position", Type::f64,
          Kind::position,    {"stream_x", "stream_y", "stream_z"},
          "length",          "position where the stream was last sorted"};
}

const Operator* operator_of(const StageOperator& stage) {
  return std::visit(
      overloaded{[]<class Kind>(const std::shared_ptr<const Kind>& op) -> const Operator* { return op.get(); },
                 [](const NotePosition&) -> const Operator* { return nullptr; }},
      stage);
}

std::string name_of(const StageOperator& stage) {
  const Operator* op = operator_of(stage);
  return op != nullptr ? op->name() : "resort";
}

Contract contract_of(const StageOperator& stage) {
  const Operator* op = operator_of(stage);
  return op != nullptr ? op->contract() : Contract{.makes = {stream_position_attribute()}, .default_k = 0};
}

StageOperator bound(const StageOperator& stage, const Schema& input, std::span<const Attribute> made) {
  return std::visit(overloaded{[&]<class Kind>(const std::shared_ptr<const Kind>& op) -> StageOperator {
                                 const std::shared_ptr<const Kind> other = op->bound(input, made);
                                 return other ? other : op;
                               },
                               [](const NotePosition& note) -> StageOperator { return note; }},
                    stage);
}

bool drops_rows(const StageOperator& stage) {
  return std::visit(
      overloaded{[](const std::shared_ptr<const LocalOperator>&) { return false; },
                 [](const std::shared_ptr<const SelectOperator>&) { return true; },
                 [](const std::shared_ptr<const InOrderOperator>& op) { return op->in_order_contract().drops_rows; },
                 [](const std::shared_ptr<const ConnectOperator>&) { return false; },
                 [](const NotePosition&) { return false; }},
      stage);
}

bool is_pointwise(const StageOperator& stage) {
  return std::visit(
      overloaded{[](const std::shared_ptr<const LocalOperator>& op) { return op->contract().default_k == 0; },
                 [](const std::shared_ptr<const SelectOperator>&) { return true; },
                 [](const std::shared_ptr<const InOrderOperator>&) { return false; },
                 [](const std::shared_ptr<const ConnectOperator>&) { return false; },
                 [](const NotePosition&) { return true; }},
      stage);
}

void apply(const StageOperator& stage, const Neighborhoods& in, Columns& out) {
  std::visit(
      overloaded{[&](const std::shared_ptr<const LocalOperator>& op) { op->apply(in, out); },
                 [&](const std::shared_ptr<const SelectOperator>& op) { op->keep(in, out.column<std::uint8_t>(0)); },
                 [](const std::shared_ptr<const InOrderOperator>&) {},
                 [](const std::shared_ptr<const ConnectOperator>&) {},
                 [&](const NotePosition&) { note_positions(in, out); }},
      stage);
}

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
                   return {{"attributes", list_of_words(drop.attributes)}};
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
