// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/planned_sweeps.h"

#include <algorithm>
#include <array>
#include <set>

#include "pointsweep/error.h"
#include "pointsweep/operators/update_operators.h"
#include "pointsweep/pipeline/pass_schedule.h"

namespace pointsweep {
namespace {

using Attributes = std::vector<Attribute>;
using Operators = std::vector<std::shared_ptr<const Operator>>;

const Attribute* find(const Attributes& attributes, const std::string& name) {
  const auto at = std::ranges::find(attributes, name, &Attribute::name);
  return at == attributes.end() ? nullptr : &*at;
}

/// Remembers where the points are when the stream is sorted again.
class NoteStreamPosition final : public Operator {
 public:
  std::string name() const override { return "resort"; }
  Contract contract() const override { return {{}, {}, {stream_position_attribute()}, true}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    const auto position = out.column<std::array<double, 3>>(0);
    for (std::size_t i = 0; i < in.size(); ++i) {
      const Vec3 p = in.position(i);
      position[i] = {p.x, p.y, p.z};
    }
  }
};

bool is_update(const std::shared_ptr<const Operator>& op) {
  return dynamic_cast<const Reneighbor*>(op.get()) != nullptr || dynamic_cast<const Resort*>(op.get()) != nullptr;
}

bool selects(const std::shared_ptr<const Operator>& op) { return op->contract().selects != Selects::nothing; }

Attributes without_selection(Attributes made) {
  std::erase_if(made, [](const Attribute& a) { return a.name == selection_attribute().name; });
  return made;
}

/// The Resort that decides the order of the output: the last one, if points may have moved before it.
Operators::const_iterator deciding_resort(const Operators& operators) {
  const auto is_resort = [](const auto& op) { return dynamic_cast<const Resort*>(op.get()) != nullptr; };
  const auto moves = [](const auto& op) { return find(op->contract().makes, position_attribute().name) != nullptr; };
  const auto found = std::find_if(operators.rbegin(), operators.rend(), is_resort);
  if (found == operators.rend() || std::none_of(found, operators.rend(), moves)) return operators.end();
  return std::prev(found.base());
}

/// The chain without what makes nothing to be written: every contract must hold in it, whatever is cut where.
Chain stages_of(const Chain& chain, const Operators& operators) {
  Chain out = chain;
  out.operators = operators;
  std::erase_if(out.operators, [](const auto& op) { return is_update(op) || selects(op); });
  return out;
}

/// Whether a stage of the first segment needs a value of the input.
bool begins_with_input_values(const Operators& operators) {
  for (const auto& op : operators) {
    if (selects(op) || dynamic_cast<const Reneighbor*>(op.get()) != nullptr) return false;
    const Contract contract = op->contract();
    if (std::ranges::any_of(contract.values, [](const auto& value) { return value->of_input(); })) return true;
  }
  return false;
}

std::vector<ScheduledPass> schedule(const Neighborhood& neighborhood, const Operators& operators,
                                    bool note_stream_position) {
  const auto deciding = note_stream_position ? deciding_resort(operators) : operators.end();
  PassSchedule schedule(neighborhood, begins_with_input_values(operators));
  for (auto op = operators.begin(); op != operators.end(); ++op) {
    if (const auto* update = dynamic_cast<const Reneighbor*>(op->get()))
      schedule.renew(update->neighborhood());
    else if (op == deciding)
      schedule.add(std::make_shared<NoteStreamPosition>());
    else if (!is_update(*op))
      schedule.add(*op);
  }
  return std::move(schedule).passes();
}

/// `before`, with the newer versions and the new ones of `made`.
Attributes updated(Attributes before, const Attributes& made) {
  for (const Attribute& a : made) {
    const auto known = std::ranges::find(before, a.name, &Attribute::name);
    known == before.end() ? before.push_back(a) : void(*known = a);
  }
  return before;
}

bool reads(const PlannedChain& planned, const Schema& schema, const Attribute& attribute) {
  const auto is_read = [&](const std::string& field) {
    const std::string& name = schema.fields[*schema.find(field)].name;
    return std::ranges::any_of(planned.file_fields,
                               [&](const auto& names) { return std::ranges::find(names, name) != names.end(); });
  };
  return std::ranges::any_of(attribute.fields, is_read);
}

/// A pass while it is not known yet which of its results are used.
struct Draft {
  ScheduledPass pass;
  Attributes carried;  ///< before it
  Attributes makes;
  std::set<std::string> needed;  ///< after it
};

/// From the last to the first: what is kept, and what later passes read and do not make. One that makes nothing of that
/// and leaves out no rows is dropped.
void find_needed(std::vector<Draft>& drafts, std::set<std::string> needed, const Schema& input) {
  std::set<std::size_t> needed_values;
  for (std::size_t d = drafts.size(); d-- > 0;) {
    Draft& draft = drafts[d];
    std::erase_if(draft.pass.values, [&](const PlannedValue& v) { return !needed_values.contains(v.number); });
    for (const PlannedValue& v : draft.pass.values)
      if (!v.reduction->of_input())
        for (const Attribute& a : v.reduction->reads()) needed.insert(a.name);
    std::vector<std::string>& keep = draft.pass.chain.keep;
    for (const Attribute& a : draft.makes)
      if (needed.contains(a.name)) keep.push_back(a.name);
    if (keep.empty() && !draft.pass.selects && draft.pass.values.empty()) {
      drafts.erase(drafts.begin() + static_cast<std::ptrdiff_t>(d));
      continue;
    }
    draft.needed = needed;
    if (draft.pass.selects) keep.push_back(selection_attribute().name);
    for (const auto& numbers : draft.pass.values_of_stages) needed_values.insert(numbers.begin(), numbers.end());
    for (const Attribute& a : draft.makes) needed.erase(a.name);
    const Schema schema = with_carried(input, draft.carried);
    const PlannedChain planned = plan_chain(draft.pass.chain, schema);
    for (const Attribute& a : draft.carried)
      if (a.name == position_attribute().name || reads(planned, schema, a)) needed.insert(a.name);
  }
}

std::vector<Draft> draft_passes(std::vector<ScheduledPass> passes, const Schema& input) {
  std::vector<Draft> drafts;
  Attributes carried;
  for (ScheduledPass& pass : passes) {
    PlannedChain planned = plan_chain(pass.chain, with_carried(input, carried));
    const Attributes made = without_selection(std::move(planned.made));
    drafts.push_back({std::move(pass), carried, made, {}});
    carried = updated(std::move(carried), made);
  }
  return drafts;
}

/// Makes what the pass is to keep; nothing if that is nothing.
PlannedChain planned_pass(const Chain& chain, const Schema& input) {
  PlannedChain planned = plan_chain(chain, input);
  if (!chain.keep.empty()) return planned;
  planned.made.clear();
  planned.plan.results.clear();
  planned.plan.result_bytes = 0;
  return planned;
}

Attributes only(Attributes attributes, const std::set<std::string>& names) {
  std::erase_if(attributes, [&](const Attribute& a) { return !names.contains(a.name); });
  return attributes;
}

/// Puts what a sweep makes into the order of `order`, which names all of it.
void put_in_order(PlannedChain& planned, const Attributes& order) {
  const std::vector<ResultColumn> results = std::move(planned.plan.results);
  const Attributes made = std::move(planned.made);
  planned.plan.results.clear();
  planned.made.clear();
  std::uint32_t offset = 0;
  for (const Attribute& a : order) {
    const auto at = std::ranges::find(made, a.name, &Attribute::name) - made.begin();
    ResultColumn& result = planned.plan.results.emplace_back(results[static_cast<std::size_t>(at)]);
    planned.made.push_back(a);
    result.offset = offset;
    offset += result.bytes;
  }
}

}  // namespace

Attribute stream_position_attribute() {
  return {"stream_position", Type::f64,
          Kind::position,    {"stream_x", "stream_y", "stream_z"},
          "length",          "position where the stream was last sorted"};
}

Schema with_carried(const Schema& input, const Attributes& carried) {
  Schema schema = input;
  for (const Attribute& a : carried) {
    for (const std::string& name : a.fields) {
      const auto known = input.find(name);
      const std::size_t added = schema.append(known ? input.fields[*known].name : name, a.type);
      if (!known) continue;
      schema.fields[*known] = schema.fields[added];
      schema.fields.pop_back();
    }
  }
  return schema;
}

bool PlannedSweeps::selects() const {
  return std::ranges::any_of(sweeps, [](const PlannedSweep& sweep) { return sweep.selects; });
}

Operators flattened(const Operators& operators, const Schema& input) {
  Operators out;
  Attributes made;
  for (const auto& op : operators) {
    Operators parts = op->parts();
    if (parts.empty()) parts = {op};
    for (auto& part : parts) {
      if (auto bound = part->bound(input, made)) part = std::move(bound);
      if (!selects(part)) made = updated(std::move(made), part->contract().makes);
      out.push_back(std::move(part));
    }
  }
  return out;
}

PlannedSweeps plan_sweeps(const Chain& chain, const Schema& input, bool ordered) {
  PlannedSweeps out;
  const Operators operators = flattened(chain.operators, input);
  PlannedChain whole = plan_chain(stages_of(chain, operators), input);
  out.made = std::move(whole.made);
  out.kept = std::move(whole.kept);
  if (out.made.empty() && std::ranges::none_of(operators, selects))
    fail_usage("The pipeline makes nothing; add an operator, as in knn(k=8) | normals.");
  out.by_moved_positions = ordered && deciding_resort(operators) != operators.end();
  std::set<std::string> needed;
  for (const Attribute& a : out.made) needed.insert(a.name);
  if (out.by_moved_positions) needed.insert(stream_position_attribute().name);

  std::vector<Draft> drafts = draft_passes(schedule(chain.neighborhood, operators, ordered), input);
  find_needed(drafts, std::move(needed), input);
  Attributes carried;
  for (const Draft& draft : drafts) {
    PlannedSweep& sweep = out.sweeps.emplace_back();
    sweep.kind = draft.pass.kind;
    sweep.selects = draft.pass.selects;
    sweep.values = draft.pass.values;
    sweep.values_of_stages = draft.pass.values_of_stages;
    sweep.input = with_carried(input, carried);
    sweep.chain = planned_pass(draft.pass.chain, sweep.input);
    carried = only(updated(std::move(carried), without_selection(sweep.chain.made)), draft.needed);
    sweep.carried = carried;
  }
  out.sweeps.back().carried = out.made;
  if (out.by_moved_positions) out.sweeps.back().carried.push_back(stream_position_attribute());
  const PlannedSweep& last = out.sweeps.back();
  const bool makes_all = last.kind == PassKind::sweep && last.input.stride == input.stride && !last.selects;
  // Where others were left out, it may make things in another order than the whole chain.
  if (makes_all) put_in_order(out.sweeps.back().chain, out.sweeps.back().carried);
  out.reorders = ordered && (!makes_all || out.by_moved_positions);
  return out;
}

}  // namespace pointsweep
