// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/pass_schedule.h"

#include <algorithm>

#include "pointsweep/error.h"

namespace pointsweep {
namespace {

/// Every stage may look at its own position, and one that is not alone at those of its neighbours.
std::vector<std::string> read_by(const Contract& contract) {
  std::vector<std::string> names = {position_attribute().name};
  for (const auto* attributes : {&contract.reads, &contract.reads_neighbors})
    for (const Attribute& a : *attributes) names.push_back(a.name);
  return names;
}

}  // namespace

void PassSchedule::add(const std::shared_ptr<const Operator>& op) {
  const Contract contract = op->contract();
  if (contract.selects != Selects::nothing) return add_select(op);
  std::size_t from = earliest(contract);
  const std::vector<std::size_t> values = find_values(contract, from);
  const std::size_t pass = pass_for(*op, contract, from);
  passes_[pass].chain.operators.push_back(op);
  passes_[pass].values_of_stages.push_back(values);
  note_use(contract, pass);
}

void PassSchedule::renew(const std::optional<Neighborhood>& neighborhood) {
  neighborhood_ = neighborhood.value_or(neighborhood_);
  begin_segment();
}

/// A select is the last of its segment: whatever was asked for before it is made of all rows.
void PassSchedule::add_select(const std::shared_ptr<const Operator>& op) {
  const bool by_value = op->contract().selects == Selects::by_value;
  const bool last_may =
      passes_.size() > segment_ && passes_.back().kind == PassKind::rows && passes_.back().values.empty();
  ScheduledPass& pass = by_value && last_may ? passes_.back() : new_pass(by_value ? PassKind::rows : PassKind::order);
  pass.selects = true;
  pass.chain.operators.push_back(op);
  pass.values_of_stages.emplace_back();
  input_values_.clear();
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
std::size_t PassSchedule::find_input_value(const std::shared_ptr<const Reduction>& reduction, std::size_t& earliest) {
  const std::size_t after = segment_ == 0 ? 0 : segment_ - 1;
  const auto [known, is_new] = input_values_.try_emplace(reduction->text(), values_, after);
  if (is_new) passes_[after].values.push_back({reduction, values_++});
  earliest = std::max(earliest, known->second.second + 1);
  return known->second.first;
}

std::size_t PassSchedule::find_value(const std::shared_ptr<const Reduction>& reduction, std::size_t& earliest) {
  const std::size_t after = known_after(*reduction);
  if (after >= passes_.size()) new_pass(PassKind::rows);
  // It reads what the pass leaves, so a stage that remakes that comes later.
  for (const Attribute& a : reduction->reads()) {
    Use& use = used_.try_emplace(a.name, Use{segment_, segment_}).first->second;
    use.read = std::max(use.read, after + 1);
  }
  earliest = std::max(earliest, after + 1);
  std::vector<PlannedValue>& values = passes_[after].values;
  const auto same = [&](const PlannedValue& v) { return v.reduction->text() == reduction->text(); };
  const auto known = std::ranges::find_if(values, same);
  if (known != values.end()) return known->number;
  values.push_back({reduction, values_});
  return values_++;
}

/// Finds a place for the values that a stage needs; it comes after all of them.
std::vector<std::size_t> PassSchedule::find_values(const Contract& contract, std::size_t& earliest) {
  std::vector<std::size_t> numbers;
  for (const auto& reduction : contract.values)
    numbers.push_back(reduction->of_input() ? find_input_value(reduction, earliest) : find_value(reduction, earliest));
  return numbers;
}

std::size_t PassSchedule::pass_for(const Operator& op, const Contract& contract, std::size_t earliest) {
  const bool alone = contract.alone && contract.reads_neighbors.empty();
  for (std::size_t p = earliest; p < passes_.size(); ++p)
    if (alone || passes_[p].kind == PassKind::sweep) {
      if (!alone) require_search_positions(op, p);
      return p;
    }
  new_pass(alone && !contract.values.empty() ? PassKind::rows : PassKind::sweep);
  if (!alone) require_search_positions(op, passes_.size() - 1);
  return passes_.size() - 1;
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

void PassSchedule::note_use(const Contract& contract, std::size_t pass) {
  for (const std::string& name : read_by(contract)) {
    Use& use = used_.try_emplace(name, Use{segment_, segment_}).first->second;
    use.read = std::max(use.read, pass);
  }
  for (const Attribute& a : contract.makes) used_[a.name] = {.made = pass, .read = pass, .is_made = true};
}

ScheduledPass& PassSchedule::new_pass(PassKind kind) {
  ScheduledPass& pass = passes_.emplace_back();
  pass.kind = kind;
  pass.chain.neighborhood = neighborhood_;
  return pass;
}

}  // namespace pointsweep
