// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/planned_sweeps.h"

#include <algorithm>
#include <array>
#include <set>

#include "pointsweep/error.h"
#include "pointsweep/operators/update_operators.h"

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

/// The Resort that decides the order of the output: the last one, if points may have moved before it.
Operators::const_iterator deciding_resort(const Operators& operators) {
  const auto is_resort = [](const auto& op) { return dynamic_cast<const Resort*>(op.get()) != nullptr; };
  const auto moves = [](const auto& op) { return find(op->contract().makes, position_attribute().name) != nullptr; };
  const auto found = std::find_if(operators.rbegin(), operators.rend(), is_resort);
  if (found == operators.rend() || std::none_of(found, operators.rend(), moves)) return operators.end();
  return std::prev(found.base());
}

/// The chain without its update operators: every contract must hold in it, whatever is cut where.
Chain without_updates(const Chain& chain) {
  Chain out = chain;
  std::erase_if(out.operators, is_update);
  return out;
}

std::vector<Chain> cut(const Chain& chain, bool note_stream_position) {
  const auto deciding = note_stream_position ? deciding_resort(chain.operators) : chain.operators.end();
  std::vector<Chain> pieces = {{.neighborhood = chain.neighborhood, .operators = {}}};
  for (auto op = chain.operators.begin(); op != chain.operators.end(); ++op) {
    if (const auto* update = dynamic_cast<const Reneighbor*>(op->get())) {
      pieces.push_back({.neighborhood = update->neighborhood().value_or(pieces.back().neighborhood), .operators = {}});
    } else if (op == deciding) {
      pieces.back().operators.push_back(std::make_shared<NoteStreamPosition>());
    } else if (!is_update(*op)) {
      pieces.back().operators.push_back(*op);
    }
  }
  return pieces;
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

/// A sweep of the chain while it is not known yet what of its results anybody needs.
struct Draft {
  Chain chain;
  Attributes carried;  ///< before it
  Attributes makes;
  std::set<std::string> needed;  ///< after it
};

/// From the last to the first: what is kept, and what later sweeps read and do not make. One that makes nothing of that
/// is left out.
void find_needed(std::vector<Draft>& drafts, std::set<std::string> needed, const Schema& input) {
  for (std::size_t d = drafts.size(); d-- > 0;) {
    Draft& draft = drafts[d];
    draft.chain.keep.clear();
    for (const Attribute& a : draft.makes)
      if (needed.contains(a.name)) draft.chain.keep.push_back(a.name);
    if (draft.chain.keep.empty()) {
      drafts.erase(drafts.begin() + static_cast<std::ptrdiff_t>(d));
      continue;
    }
    draft.needed = needed;
    for (const Attribute& a : draft.makes) needed.erase(a.name);
    const Schema schema = with_carried(input, draft.carried);
    const PlannedChain planned = plan_chain(draft.chain, schema);
    for (const Attribute& a : draft.carried)
      if (a.name == position_attribute().name || reads(planned, schema, a)) needed.insert(a.name);
  }
}

std::vector<Draft> draft_sweeps(const Chain& chain, const Schema& input, bool ordered) {
  std::vector<Draft> drafts;
  Attributes carried;
  for (Chain& piece : cut(chain, ordered)) {
    PlannedChain planned = plan_chain(piece, with_carried(input, carried));
    drafts.push_back({std::move(piece), carried, planned.made, {}});
    carried = updated(std::move(carried), planned.made);
  }
  return drafts;
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

PlannedSweeps plan_sweeps(const Chain& chain, const Schema& input, bool ordered) {
  PlannedSweeps out;
  PlannedChain whole = plan_chain(without_updates(chain), input);
  out.made = std::move(whole.made);
  out.kept = std::move(whole.kept);
  if (out.made.empty()) fail_usage("The pipeline makes nothing; add an operator, as in knn(k=8) | normals.");
  out.by_moved_positions = ordered && deciding_resort(chain.operators) != chain.operators.end();
  std::set<std::string> needed;
  for (const Attribute& a : out.made) needed.insert(a.name);
  if (out.by_moved_positions) needed.insert(stream_position_attribute().name);

  std::vector<Draft> drafts = draft_sweeps(chain, input, ordered);
  find_needed(drafts, std::move(needed), input);
  Attributes carried;
  for (const Draft& draft : drafts) {
    PlannedSweep& sweep = out.sweeps.emplace_back();
    sweep.input = with_carried(input, carried);
    sweep.chain = plan_chain(draft.chain, sweep.input);
    carried = only(updated(std::move(carried), sweep.chain.made), draft.needed);
    sweep.carried = carried;
  }
  out.sweeps.back().carried = out.made;
  if (out.by_moved_positions) out.sweeps.back().carried.push_back(stream_position_attribute());
  // Where others were left out, it may make things in another order than the whole chain.
  if (out.sweeps.size() == 1) put_in_order(out.sweeps.back().chain, out.sweeps.back().carried);
  out.reorders = ordered && (out.sweeps.size() > 1 || out.by_moved_positions);
  return out;
}

}  // namespace pointsweep
