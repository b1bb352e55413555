// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/plan/pass_schedule.h"

#include <algorithm>

#include "pointsweep/fail.h"
#include "pointsweep/operators/connecting_operator.h"
#include "pointsweep/operators/ordered_operator.h"

namespace pointsweep {
namespace {

/// Every stage may look at its own position, and one that is not alone at those of its neighbours.
std::vector<std::string> read_by(const Contract& contract) {
  std::vector<std::string> names = {position_attribute().name};
  for (const auto* attributes : {&contract.reads, &contract.reads_neighbors})
    for (const Attribute& a : *attributes) names.push_back(a.name);
  return names;
}

bool connects(const Operator& op) { return dynamic_cast<const ConnectingOperator*>(&op) != nullptr; }
bool takes_in_order(const Operator& op) { return dynamic_cast<const OrderedOperator*>(&op) != nullptr; }

/// Whether a stage of the first segment needs a value of the input, for which the rows are read first.
bool begins_with_input_values(const ChainGraph& graph) {
  bool any_stage = false;
  for (const GraphNode& node : graph.nodes) {
    if (node.kind == NodeKind::select || (node.kind == NodeKind::neighborhood && any_stage)) return false;
    if (node.kind == NodeKind::reduce && node.reduction->of_input()) return true;
    any_stage |= node.kind == NodeKind::stage;
  }
  return false;
}

}  // namespace

bool is_pointwise(const Operator& op) {
  const Contract contract = op.contract();
  const bool is_in_order = contract.selects == Selects::in_order || takes_in_order(op);
  return contract.alone && contract.reads_neighbors.empty() && !is_in_order;
}

PassSchedule::PassSchedule(const ChainGraph& graph) : graph_(graph) {
  if (begins_with_input_values(graph)) new_pass(PassKind::rows);
}

/// A pass of pointwise stages alone needs no search and only reads the rows.
std::vector<ScheduledPass> PassSchedule::passes() {
  for (std::size_t n = 1; n < graph_.nodes.size(); ++n) add(n);
  const auto needs_no_search = [&](std::size_t n) { return is_pointwise(*graph_.nodes[n].op); };
  for (ScheduledPass& pass : passes_)
    if (pass.kind == PassKind::sweep && std::ranges::all_of(pass.stages, needs_no_search)) pass.kind = PassKind::rows;
  return std::move(passes_);
}

void PassSchedule::add(std::size_t node) {
  switch (graph_.nodes[node].kind) {
    case NodeKind::stage:
      return add_stage(node);
    case NodeKind::select:
      return add_select(node);
    case NodeKind::neighborhood:
      neighborhood_ = node;
      return begin_segment();
    case NodeKind::order:
      if (graph_.nodes[node].op) add_stage(node);
      return;
    case NodeKind::reduce:  // with the first stage that needs it
      return;
  }
}

void PassSchedule::add_stage(std::size_t node) {
  const Operator& op = *graph_.nodes[node].op;
  const Contract contract = op.contract();
  const std::size_t readable = earliest(contract), known = known_after_values(graph_.nodes[node].values);
  const std::size_t pass = takes_in_order(op)
                               ? (new_pass(PassKind::order), passes_.size() - 1)
                               : pass_for(op, contract, std::max(readable, known));
  passes_[pass].stages.push_back(node);
  passes_[pass].connects |= connects(op);
  note_use(contract, pass, connects(op) ? pass + 1 : pass);
}

/// A select is the last of its segment: whatever was asked for before it is made of all rows.
void PassSchedule::add_select(std::size_t node) {
  const bool by_value = graph_.nodes[node].op->contract().selects == Selects::by_value;
  const bool last_may =
      passes_.size() > segment_ && passes_.back().kind == PassKind::rows && passes_.back().reduces.empty();
  ScheduledPass& pass = by_value && last_may ? passes_.back() : new_pass(by_value ? PassKind::rows : PassKind::order);
  pass.selects = true;
  pass.stages.push_back(node);
  begin_segment();
}

void PassSchedule::begin_segment() {
  segment_ = passes_.size();
  used_.clear();
}

/// The first pass in which what the stage reads is there, and what it remakes is not read any more.
std::size_t PassSchedule::earliest(const Contract& contract) const {
  std::size_t pass = segment_;
  for (const std::string& name : read_by(contract))
    if (const auto used = used_.find(name); used != used_.end()) pass = std::max(pass, used->second.made);
  for (const Attribute& a : contract.makes)
    if (const auto used = used_.find(a.name); used != used_.end())
      pass = std::max({pass, used->second.made, used->second.read});
  return pass;
}

/// The pass whose end tells the value.
std::size_t PassSchedule::known_after(const Reduction& reduction) const {
  std::size_t pass = segment_;
  for (const Attribute& a : reduction.reads())
    if (const auto used = used_.find(a.name); used != used_.end()) pass = std::max(pass, used->second.made);
  return pass;
}

/// The end of the pass before the segment tells it, or the reading of rows at the beginning of the chain.
std::size_t PassSchedule::find_input_value() { return segment_ == 0 ? 0 : segment_ - 1; }

std::size_t PassSchedule::find_value(const Reduction& reduction) {
  const std::size_t after = known_after(reduction);
  if (after >= passes_.size()) new_pass(PassKind::rows);
  // It reads what the pass leaves, so a stage that remakes that comes later.
  for (const Attribute& a : reduction.reads()) {
    Use& use = used_.try_emplace(a.name, Use{segment_, segment_}).first->second;
    use.read = std::max(use.read, after + 1);
  }
  return after;
}

/// Finds a place for the values that a stage needs, and returns the first pass in which all are known.
std::size_t PassSchedule::known_after_values(const std::vector<std::size_t>& reduces) {
  std::size_t known = 0;
  for (const std::size_t reduce : reduces) {
    if (!value_of_.contains(reduce)) {
      const Reduction& reduction = *graph_.nodes[reduce].reduction;
      const std::size_t after = reduction.of_input() ? find_input_value() : find_value(reduction);
      value_of_[reduce] = after;
      passes_[after].reduces.push_back(reduce);
    }
    known = std::max(known, value_of_.at(reduce) + 1);
  }
  return known;
}

std::size_t PassSchedule::pass_for(const Operator& op, const Contract& contract, std::size_t earliest) {
  const bool alone = is_pointwise(op);
  for (std::size_t p = earliest; p < passes_.size(); ++p)
    if (takes(passes_[p], op, alone)) {
      if (!alone) require_search_positions(op, p);
      return p;
    }
  const bool follows = passes_.size() > segment_ && (passes_.back().kind == PassKind::order || passes_.back().connects);
  new_pass(alone && (follows || !contract.values.empty()) ? PassKind::rows : PassKind::sweep);
  if (!alone) require_search_positions(op, passes_.size() - 1);
  return passes_.size() - 1;
}

bool PassSchedule::takes(const ScheduledPass& pass, const Operator& op, bool alone) const {
  if (connects(op)) return pass.kind == PassKind::sweep && !pass.connects;
  return pass.kind == PassKind::sweep || (alone && pass.kind == PassKind::rows);
}

/// A sweep searches at the positions with which it begins.
void PassSchedule::require_search_positions(const Operator& op, std::size_t pass) const {
  const auto moved = used_.find(position_attribute().name);
  if (moved == used_.end() || !moved->second.is_made || moved->second.made >= pass) return;
  fail_usage(
      "{}: needs a value of the whole cloud and the neighbours that points had before they moved; add reneighbor "
      "before "
      "'{}', or move the points later.",
      op.name(), op.name());
}

void PassSchedule::note_use(const Contract& contract, std::size_t pass, std::size_t made) {
  for (const std::string& name : read_by(contract)) {
    Use& use = used_.try_emplace(name, Use{segment_, segment_}).first->second;
    use.read = std::max(use.read, pass);
  }
  for (const Attribute& a : contract.makes) used_[a.name] = {.made = made, .read = pass, .is_made = true};
}

ScheduledPass& PassSchedule::new_pass(PassKind kind) {
  ScheduledPass& pass = passes_.emplace_back();
  pass.kind = kind;
  pass.neighborhood = neighborhood_;
  return pass;
}

}  // namespace pointsweep
