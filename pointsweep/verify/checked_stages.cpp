// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdint>
#include <set>

#include "pointsweep/fail.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/overloaded.h"
#include "pointsweep/reader.h"
#include "pointsweep/storage/local/place.h"
#include "pointsweep/storage/remote/url.h"
#include "pointsweep/verify/values/cloud_formula.h"
#include "pointsweep/verify/values/kept_rows.h"
#include "pointsweep/verify/verify.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

fs::path found_input(const ProvenanceInput& input, const fs::path& file) {
  const fs::path name = file_name(input.name);
  const bool is_whole = fs::path(input.name).is_absolute() || is_url(input.name);
  std::optional<fs::path> other;  // a file with the name of the input but another size
  std::uint64_t other_bytes = 0;
  for (const fs::path& place : {is_whole ? fs::path(input.name) : fs::path(), file.parent_path() / name, name}) {
    const std::optional<std::uint64_t> bytes = place.empty() ? std::nullopt : bytes_of_file(place);
    if (!bytes) continue;
    if (*bytes == input.bytes) return place;
    other = place;
    other_bytes = *bytes;
  }
  if (other)
    fail("{}: has changed since {} was made from it: it had {} bytes and has {}; name the inputs as well.",
         other->string(), file.string(), input.bytes, other_bytes);
  fail("{}: was made from '{}', which is neither in its folder nor in this one; name the inputs as well.",
       file.string(), input.name);
}

/// Returns whether the stage both drops rows and replaces values of the kept rows by means, which the input does not
/// have.
bool drops_rows_and_makes(const GraphNode& node) { return node.drops_rows() && node.makes.size() > 1; }

bool is_selection(const Attribute& a) { return a.name == selection_attribute().name; }

/// Removes the unchecked attributes from the kept attributes. If none is left, only selects are checked.
void keep_what_is_told(MadeBy& made) {
  if (made.keep.empty())
    for (const auto& op : made.operators)
      for (const Attribute& a : contract_of(op).makes) made.keep.push_back(a.name);
  for (const Attribute& again : made.unchecked) std::erase(made.keep, again.name);
  if (made.keep.empty()) leave_selects(made);
}

/// Returns whether the values of the operator come from a raster, a search or a graph over the whole cloud.
bool depends_on_all_points(const StageOperator& op) {
  return std::visit(overloaded{[](const std::shared_ptr<const LocalOperator>&) { return false; },
                               [](const std::shared_ptr<const SelectOperator>&) { return false; },
                               [](const std::shared_ptr<const InOrderOperator>&) { return true; },
                               [](const std::shared_ptr<const ConnectOperator>&) { return true; },
                               [](const NotePosition&) { return false; }},
                    op);
}

/// Returns whether the values of the stage can be computed from a sample of the input, or, by a cloud formula, from all
/// its points if they have not moved.
bool is_told_by_input(const GraphNode& node) {
  return !depends_on_all_points(*node.op()) || (!node.position && has_cloud_formula(*operator_of(*node.op())));
}

bool reads_any(const GraphNode& node, const std::set<std::size_t>& versions) {
  const auto is_one = [&](std::size_t v) { return versions.contains(v); };
  return std::ranges::any_of(node.reads, is_one) || std::ranges::any_of(node.reads_neighbors, is_one);
}

/// Adds a select that follows other stages. `is_told`: true if the attributes that its condition reads are checked.
void add_late_select(const GraphNode& node, bool is_told, MadeBy& made) {
  made.leaves_out = true;
  if (is_told) return made.operators.push_back(*node.op());
  made.leaves_out_more = true;
  made.untold.push_back("which rows '" + node.stage + "' leaves out by attributes that are not checked");
}

}  // namespace

std::optional<ProvenanceRecord> recorded_run(const fs::path& file) {
  if (is_array_name(file)) return std::nullopt;
  std::vector<ProvenanceRecord> records = records_of(open_reader(file)->info().provenance);
  if (records.empty() || records.back().stages.empty()) return std::nullopt;
  return std::move(records.back());
}

std::vector<fs::path> recorded_inputs(const ProvenanceRecord& record, const fs::path& file) {
  if (record.more_inputs > 0 || record.inputs.empty())
    fail_usage("{}: does not name all the files it was made from; name the inputs as well.", file.string());
  std::vector<fs::path> inputs;
  for (const ProvenanceInput& input : record.inputs) inputs.push_back(found_input(input, file));
  return inputs;
}

void leave_selects(MadeBy& made) {
  if (made.leaves_out)
    made.keep = {selection_attribute().name};
  else
    made.operators.clear();
}

MadeBy made_by(const ChainPlan& plan) {
  const Neighborhood& first = *plan.graph.nodes.front().neighborhood();
  const bool all = first.k == Neighborhood::kUnlimited;
  MadeBy made{.neighborhood = {.k = all ? NeighborRule::kUnlimited : first.k, .radius = first.radius},
              .rule = first.rule,
              .keep = plan.chain.keep};
  bool is_told = true, others = false;
  std::set<std::size_t> unknown;  // versions of attributes that cannot be evaluated
  for (std::size_t n = 1; n < plan.graph.nodes.size(); ++n) {
    const GraphNode& node = plan.graph.nodes[n];
    is_told &= node.neighborhood() == nullptr;
    const bool makes = !node.drops_rows() || drops_rows_and_makes(node);
    if (!makes && others)
      add_late_select(node, !reads_any(node, unknown) && !(node.position && unknown.contains(*node.position)), made);
    others |= makes;
    if (!makes || node.op() == nullptr || node.is_order()) continue;
    const bool pointwise = contract_of(*node.op()).default_k == 0 && !depends_on_all_points(*node.op());
    if (is_told && (!made.leaves_out || pointwise) && is_told_by_input(node) && !reads_any(node, unknown)) {
      made.operators.push_back(*node.op());
    } else {
      for (const std::size_t v : node.makes)
        if (!is_selection(plan.graph.versions[v].attribute)) made.unchecked.push_back(plan.graph.versions[v].attribute);
      unknown.insert(node.makes.begin(), node.makes.end());
    }
    is_told &= !node.drops_rows();
  }
  if (!made.unchecked.empty()) keep_what_is_told(made);
  return made;
}

void leave_out(const KeptFields& named, const std::string& prefix, const Schema& input, MadeBy& made) {
  const KeptFields kept = prefix.empty() ? without_replaced(named, input) : named;
  for (const std::string& field : kept.left_out) made.left_out_made.insert(prefix + field);
  if (!kept.input) return;
  for (std::size_t f = 0; f < input.fields.size(); ++f)
    if (std::ranges::find(*kept.input, f) == kept.input->end()) made.left_out_input.insert(input.fields[f].name);
}

KeptRows rows_kept_first(const VerifyOptions& options, const InputCloud& cloud, const ChainGraph& graph) {
  std::vector<StageOperator> first;
  std::optional<StageOperator> means;  // the stage voxel(keep=centroid), which follows `first`
  bool others = false;
  for (std::size_t n = 1; n < graph.nodes.size(); ++n) {
    const GraphNode& node = graph.nodes[n];
    others |= !node.drops_rows();
    if (!node.drops_rows()) continue;
    const bool by_value = std::holds_alternative<std::shared_ptr<const SelectOperator>>(*node.op());
    if (others && !means && by_value) continue;
    if (others || means)
      fail_usage(
          "verify: the stage '{}' leaves out rows after other stages, and a sample of the input does not tell which; "
          "verify the output of the stages before it.",
          node.stage);
    if (drops_rows_and_makes(node))
      means = *node.op();
    else
      first.push_back(*node.op());
  }
  const auto kept = [&](const InputCloud& from, const std::vector<StageOperator>& by) {
    return with_kept_rows(from, by, options.memory_bytes, options.progress);
  };
  InputCloud left = kept(cloud, first);
  if (!means) return {std::move(left), nullptr};
  auto before_means = std::make_shared<InputCloud>(std::move(left));
  return {kept(*before_means, {*means}), before_means};
}

}  // namespace pointsweep
