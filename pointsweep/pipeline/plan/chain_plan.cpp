// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/plan/chain_plan.h"

#include <algorithm>
#include <set>
#include <utility>

#include "pointsweep/fail.h"
#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/pipeline/plan/pass_schedule.h"
#include "pointsweep/points/input_row.h"

namespace pointsweep {
namespace {

/// Returns `open` with the k and the radius that its operators need, if it leaves k to them (kOfOperators); otherwise
/// unchanged. Its operators are the stages from `first` up to the next Reneighbor that states a neighbourhood.
Neighborhood closed(Neighborhood open, const std::vector<ChainStage>& stages, std::size_t first) {
  if (open.k != Neighborhood::kOfOperators) return open;
  std::size_t k = 0;
  std::optional<double> radius;
  std::string of_radius, of_k;
  for (std::size_t s = first; s < stages.size(); ++s) {
    const auto* next = std::get_if<Reneighbor>(&stages[s]);
    if (next != nullptr && next->neighborhood) break;
    const Operator* op = operator_of(stages[s]);
    const Contract contract = op != nullptr ? op->contract() : Contract{.default_k = 0};
    if (contract.default_k == 0) continue;
    if (contract.all_within > radius)  // an absent radius is below all others
      radius = contract.all_within, of_radius = name_of(stages[s]);
    else if (!contract.all_within)
      k = std::max(k, contract.default_k), of_k = name_of(stages[s]);
  }
  if (radius && k > 0)
    fail_usage(
        "'{}' needs all neighbours within {}, and '{}' looks at as many as the pipeline says; write knn(radius={}) "
        "before them.",
        of_radius, *radius, of_k, *radius);
  if (radius) {
    open.k = Neighborhood::kUnlimited;
    open.radius = std::min(open.radius, *radius);
  } else {
    open.k = k == 0 ? Contract().default_k : k;
  }
  return open;
}

using Attributes = std::vector<Attribute>;
using Names = std::set<std::string>;

Attributes only(Attributes attributes, const Names& names) {
  std::erase_if(attributes, [&](const Attribute& a) { return !names.contains(a.name); });
  return attributes;
}

bool is_selection(const Attribute& a) { return a.name == selection_attribute().name; }

/// A pass during planning, before the results that nothing uses are removed.
struct Draft {
  ScheduledPass pass;
  Attributes carried;  ///< attributes made by earlier passes
  Attributes makes;    ///< attributes that the pass makes, without selection_attribute()
  Names needed;        ///< names of the attributes that later passes read or the output contains
};

Attributes made_by(const ScheduledPass& pass, const ChainGraph& graph) {
  Attributes made;
  for (const std::size_t node : pass.stages)
    for (const std::size_t v : graph.nodes[node].makes) made = updated(std::move(made), {graph.versions[v].attribute});
  std::erase_if(made, is_selection);
  return made;
}

std::vector<Draft> draft_passes(std::vector<ScheduledPass> passes, const ChainGraph& graph) {
  std::vector<Draft> drafts;
  Attributes carried;
  for (ScheduledPass& pass : passes) {
    const Attributes made = made_by(pass, graph);
    drafts.push_back({std::move(pass), carried, made, {}});
    carried = updated(std::move(carried), made);
  }
  return drafts;
}

/// Returns the attributes carried into a pass that its neighbourhoods and stages read. Every pass reads positions.
Names reads_of_pass(const Draft& draft, const ChainGraph& graph, const Schema& input) {
  Names read;
  const auto note = [&](const Attribute& a) {
    for (const std::string& field : a.fields) read.insert(carried_with(field, input, draft.carried));
  };
  if (const auto& rule = graph.nodes[draft.pass.neighborhood].neighborhood()->rule)
    std::ranges::for_each(rule->reads(), note);
  std::set<std::size_t> made;
  for (const std::size_t n : draft.pass.stages) {
    const GraphNode& node = graph.nodes[n];
    for (const auto* versions : {&node.reads, &node.reads_neighbors})
      for (const std::size_t v : *versions)
        if (!made.contains(v)) note(graph.versions[v].attribute);
    made.insert(node.makes.begin(), node.makes.end());
  }
  for (const Attribute& a : draft.carried)
    if (a.name == position_attribute().name) read.insert(a.name);
  read.erase("");
  return read;
}

/// Finds, from the last pass to the first, the attributes and values that are kept or read by later passes. A pass that
/// makes none of them and drops no rows is removed.
void find_needed(std::vector<Draft>& drafts, Names needed, const ChainGraph& graph, const Schema& input) {
  std::set<std::size_t> needed_values;
  for (std::size_t d = drafts.size(); d-- > 0;) {
    Draft& draft = drafts[d];
    std::erase_if(draft.pass.reduces, [&](std::size_t node) { return !needed_values.contains(node); });
    for (const std::size_t node : draft.pass.reduces)
      if (!graph.nodes[node].reduction()->of_input())
        for (const Attribute& a : graph.nodes[node].reduction()->reads()) needed.insert(a.name);
    const auto is_needed = [&](const Attribute& a) { return needed.contains(a.name); };
    if (std::ranges::none_of(draft.makes, is_needed) && !draft.pass.selects && draft.pass.reduces.empty()) {
      drafts.erase(drafts.begin() + static_cast<std::ptrdiff_t>(d));
      continue;
    }
    draft.needed = needed;
    for (const std::size_t node : draft.pass.stages)
      needed_values.insert(graph.nodes[node].values.begin(), graph.nodes[node].values.end());
    for (const Attribute& a : draft.makes) needed.erase(a.name);
    needed.merge(reads_of_pass(draft, graph, input));
  }
}

std::vector<std::string> kept_by(const Draft& draft) {
  std::vector<std::string> kept;
  for (const Attribute& a : draft.makes)
    if (draft.needed.contains(a.name)) kept.push_back(a.name);
  if (draft.pass.selects) kept.push_back(selection_attribute().name);
  return kept;
}

/// Plans a pass. `carried`: attributes that earlier passes made and that this or a later pass, or the output, needs.
PlannedPass planned_pass(const Draft& draft, const ChainGraph& graph, const Attributes& carried,
                         std::size_t first_stage, const Schema& input) {
  PlannedPass pass;
  pass.kind = draft.pass.kind;
  pass.selects = draft.pass.selects;
  for (const std::size_t node : draft.pass.reduces)
    pass.values.push_back({std::get<std::shared_ptr<const Reduction>>(graph.nodes[node].what), node});
  pass.input = with_carried(input, carried);
  plan_columns(graph, draft.pass, carried, first_stage, kept_by(draft), pass);
  for (const std::size_t node : draft.pass.stages) pass.values_of_stages.push_back(graph.nodes[node].values);
  pass.carried = only(updated(carried, pass.made), draft.needed);
  return pass;
}

/// Sorts the attributes that a pass makes into the order of `order`, which contains the same attributes.
void put_in_order(PlannedPass& pass, const Attributes& order) {
  const std::vector<ResultColumn> results = std::move(pass.plan.results);
  const Attributes made = std::move(pass.made);
  pass.plan.results.clear();
  pass.made.clear();
  std::uint32_t offset = 0;
  for (const Attribute& a : order) {
    const auto at = std::ranges::find(made, a.name, &Attribute::name) - made.begin();
    ResultColumn& result = pass.plan.results.emplace_back(results[static_cast<std::size_t>(at)]);
    pass.made.push_back(a);
    result.offset = offset;
    offset += result.bytes;
  }
}

/// Finds the made attributes and the fields of the input that are written: those that Chain::keep keeps
/// (kept_fields()), or all, without dropped fields. Throws UsageError if a chain with stages has no effect.
void find_written(ChainPlan& plan, const Schema& input) {
  plan.made = plan.graph.made_attributes();
  Schema visible{{}, input.stride};
  std::vector<std::size_t> index;  // indices in the input
  for (std::size_t f = 0; f < input.fields.size(); ++f)
    if (!plan.graph.dropped.contains(f)) visible.fields.push_back(input.fields[f]), index.push_back(f);
  if (!plan.chain.keep.empty()) {
    plan.kept = kept_fields(plan.chain.keep, plan.made, visible);
    plan.made = only(plan.made, {plan.kept.attributes.begin(), plan.kept.attributes.end()});
  } else if (plan.graph.drops) {
    for (const Attribute& a : plan.made) plan.kept.attributes.push_back(a.name);
  }
  if (plan.kept.input)
    for (std::size_t& f : *plan.kept.input) f = index[f];
  else if (!plan.graph.dropped.empty())
    plan.kept.input = std::move(index);
  if (plan.made.empty() && !plan.selects() && !plan.graph.drops && !plan.chain.stages.empty())
    fail_usage(
        "the pipeline computes nothing; add an operator, as in knn(k=8) | normals, or leave the pipeline out to copy "
        "the points.");
}

bool orders_by_moved_positions(const ChainGraph& graph) {
  return std::ranges::any_of(graph.nodes, [](const GraphNode& n) { return n.is_order() && !n.makes.empty(); });
}

/// Sets the attributes that the last pass carries, and whether the output needs another order (ChainPlan::reorders).
void find_order(ChainPlan& plan, const Schema& input, bool ordered) {
  PlannedPass& last = plan.passes.back();
  last.carried = plan.made;
  if (plan.by_moved_positions) last.carried.push_back(stream_position_attribute());
  const bool makes_all = last.kind == PassKind::sweep && last.input.stride == input.stride && !last.selects;
  const bool in_its_order = makes_all && last.connecting_stage() == nullptr && !plan.graph.moved_bounds;
  // If other passes were omitted, this pass may make its attributes in another order than the chain.
  if (makes_all) put_in_order(last, last.carried);
  plan.reorders = ordered && (!in_its_order || plan.by_moved_positions);
}

}  // namespace

Chain with_named_neighborhoods(Chain chain) {
  chain.neighborhood = closed(std::move(chain.neighborhood), chain.stages, 0);
  for (std::size_t s = 0; s < chain.stages.size(); ++s) {
    const auto* next = std::get_if<Reneighbor>(&chain.stages[s]);
    if (next != nullptr && next->neighborhood)
      chain.stages[s] = Reneighbor(closed(*next->neighborhood, chain.stages, s + 1));
  }
  return chain;
}

ChainPlan plan_chain(const Chain& chain, const Schema& input, OutputNeeds needs) {
  ChainPlan plan;
  plan.chain = with_named_neighborhoods(chain);
  const Schema own = without_input_row(input);
  plan.graph = resolve(plan.chain, own, needs);
  const Schema read = plan.graph.reads_input_rows() ? with_input_row(own) : own;
  find_written(plan, own);
  plan.by_moved_positions = orders_by_moved_positions(plan.graph);
  Names needed;
  for (const Attribute& a : plan.made) needed.insert(a.name);
  if (plan.by_moved_positions) needed.insert(stream_position_attribute().name);
  std::vector<Draft> drafts = draft_passes(schedule_passes(plan.graph), plan.graph);
  find_needed(drafts, std::move(needed), plan.graph, read);
  if (drafts.empty()) drafts.emplace_back().pass.kind = PassKind::rows;  // the chain is empty or only drops attributes
  if (plan.graph.moved_bounds) drafts.back().pass.reduces.push_back(*plan.graph.moved_bounds);
  std::size_t stages = 0;
  for (const Draft& draft : drafts) {
    const Attributes carried = plan.passes.empty() ? Attributes{} : plan.passes.back().carried;
    plan.passes.push_back(planned_pass(draft, plan.graph, carried, stages, read));
    stages += draft.pass.stages.size();
  }
  find_order(plan, read, needs.stream_order);
  return plan;
}

bool ChainPlan::only_copies() const {
  if (passes.size() != 1 || reorders || opens_late()) return false;
  const PlannedPass& pass = passes.front();
  return pass.kind == PassKind::rows && pass.plan.stages.empty() && pass.values.empty();
}

bool ChainPlan::leaves_rows(std::size_t p) const {
  return reorders || passes[p].selects || passes[p].made.empty() || graph.moved_bounds || p + 1 < passes.size();
}

std::uint64_t ChainPlan::most_carried_bytes() const {
  std::uint64_t most = 0, before = 0;
  for (std::size_t p = 0; p < passes.size(); ++p) {
    const std::uint64_t after = leaves_rows(p) ? passes[p].carried_bytes() : 0;
    most = std::max(most, before + after);
    before = after;
  }
  return most;
}

const InOrderOperator* PlannedPass::in_order() const {
  if (kind != PassKind::order) return nullptr;
  return std::get<std::shared_ptr<const InOrderOperator>>(plan.stages.front().op).get();
}

bool PlannedPass::has_places() const {
  return kind == PassKind::order && in_order()->in_order_contract().places != Places::positions;
}

std::vector<std::byte> PlannedPass::fill_record() const {
  std::vector<std::byte> record;
  for (const Attribute& a : made) record.resize(record.size() + a.bytes(), a.fill);
  return record;
}

const Stage* PlannedPass::connecting_stage() const {
  for (const Stage& stage : plan.stages)
    if (stage.connects() != nullptr) return &stage;
  return nullptr;
}

std::uint64_t PlannedPass::carried_bytes() const { return bytes_of(carried); }

std::uint64_t PlannedPass::travelling_bytes() const {
  const PositionFields p = position_fields(input, "The input");
  const std::uint64_t place = has_places() ? sizeof(Vec3) : 0;
  std::uint64_t bytes = place + size_of(p.x.type) + size_of(p.y.type) + size_of(p.z.type);
  for (const std::size_t field : payload()) bytes += 8 * std::uint64_t{input.fields[field].count};
  return bytes;
}

std::vector<std::size_t> PlannedPass::payload() const {
  std::vector<std::size_t> indices;
  for (const auto& names : file_fields) {
    for (const std::string& name : names) {
      const auto at = std::ranges::find(input.fields, name, &Field::name);
      const auto index = static_cast<std::size_t>(at - input.fields.begin());
      if (std::ranges::find(indices, index) == indices.end()) indices.push_back(index);
    }
  }
  return indices;
}

void PlannedPass::bind(const Schema& working_record) {
  for (std::size_t c = 0; c < file_fields.size(); ++c) {
    plan.file_columns[c].fields.clear();
    for (const std::string& name : file_fields[c]) {
      const auto at = std::ranges::find(working_record.fields, name, &Field::name);
      plan.file_columns[c].fields.push_back(static_cast<std::size_t>(at - working_record.fields.begin()));
    }
  }
}

}  // namespace pointsweep
