// SPDX-License-Identifier: MIT
#include "pointsweep/verify/checked_stages.h"

#include <algorithm>
#include <set>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/operators/connecting_operator.h"
#include "pointsweep/operators/drop.h"
#include "pointsweep/operators/ordered_operator.h"
#include "pointsweep/operators/voxel.h"
#include "pointsweep/operators/voxel_centroid.h"
#include "pointsweep/verify/cloud_formula.h"
#include "pointsweep/verify/kept_rows.h"

namespace pointsweep {
namespace {

template <class Op>
const Op* as(const GraphNode& node) {
  return dynamic_cast<const Op*>(node.op.get());
}

bool leaves_means(const GraphNode& node) { return as<KeepVoxelMeans>(node) != nullptr; }

/// What is made again behind a new neighbourhood is not checked.
void keep_what_is_told(MadeBy& made) {
  if (made.keep.empty())
    for (const auto& op : made.operators)
      for (const Attribute& a : op->contract().makes) made.keep.push_back(a.name);
  for (const Attribute& again : made.unchecked) std::erase(made.keep, again.name);
  if (made.keep.empty()) leave_selects(made);
}

/// Its values are those of a raster, of a search, or of a graph over the whole cloud.
bool depends_on_all_points(const GraphNode& node) {
  return dynamic_cast<const OrderedOperator*>(node.op.get()) != nullptr ||
         dynamic_cast<const ConnectingOperator*>(node.op.get()) != nullptr;
}

/// Whether a sample of the input, and all its points where they are, tell what the stage makes.
bool is_told_by_input(const GraphNode& node) {
  return !depends_on_all_points(node) || (!node.position && has_cloud_formula(*node.op));
}

bool reads_any(const GraphNode& node, const std::set<std::size_t>& versions) {
  const auto is_one = [&](std::size_t v) { return versions.contains(v); };
  return std::ranges::any_of(node.reads, is_one) || std::ranges::any_of(node.reads_neighbors, is_one);
}

/// A select behind other stages: its condition is evaluated on what they make.
void add_late_select(const GraphNode& node, bool is_told, MadeBy& made) {
  made.leaves_out = true;
  if (is_told) return made.operators.push_back(node.op);
  made.leaves_out_more = true;
  made.untold.push_back("which rows '" + node.stage + "' leaves out by attributes that are not checked");
}

}  // namespace

void leave_selects(MadeBy& made) {
  if (made.leaves_out)
    made.keep = {selection_attribute().name};
  else
    made.operators.clear();
}

MadeBy made_by(const ChainPlan& plan) {
  const Neighborhood& first = plan.graph.nodes.front().neighborhood;
  const bool all = first.k == Neighborhood::kUnlimited;
  MadeBy made{.neighborhood = {.k = all ? NeighborRule::kUnlimited : first.k, .radius = first.radius},
              .rule = first.rule,
              .keep = plan.chain.keep};
  bool is_told = true, others = false;
  std::set<std::size_t> unknown;  // versions
  for (std::size_t n = 1; n < plan.graph.nodes.size(); ++n) {
    const GraphNode& node = plan.graph.nodes[n];
    is_told &= node.kind != NodeKind::neighborhood && !leaves_means(node);
    if (node.kind == NodeKind::select && others && !leaves_means(node)) {
      add_late_select(node, !reads_any(node, unknown) && !(node.position && unknown.contains(*node.position)), made);
      continue;
    }
    others |= node.kind != NodeKind::select && as<AllRows>(node) == nullptr;
    if (node.kind != NodeKind::stage) continue;
    const bool in_place = !made.leaves_out || (node.op->contract().alone && !depends_on_all_points(node));
    if (is_told && in_place && is_told_by_input(node) && !reads_any(node, unknown)) {
      made.operators.push_back(node.op);
      continue;
    }
    for (const std::size_t v : node.makes) made.unchecked.push_back(plan.graph.versions[v].attribute);
    unknown.insert(node.makes.begin(), node.makes.end());
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

std::shared_ptr<InputCloud> select_rows(const VerifyOptions& options, InputCloud& cloud, const ChainGraph& graph,
                                        const std::function<std::shared_ptr<InputCloud>()>& open_again) {
  std::vector<std::shared_ptr<const Operator>> first;
  std::shared_ptr<InputCloud> before_means;
  const VoxelMeans* means = nullptr;
  bool others = false;
  for (std::size_t n = 1; n < graph.nodes.size(); ++n) {
    const GraphNode& node = graph.nodes[n];
    if (as<AllRows>(node) != nullptr || as<TakeVoxelMeans>(node) != nullptr) continue;
    if (!others && as<VoxelMeans>(node) != nullptr) {
      means = as<VoxelMeans>(node);
      continue;
    }
    if (node.kind == NodeKind::select && others && !before_means && !leaves_means(node) &&
        node.op->contract().selects == Selects::by_value)
      continue;
    if (node.kind == NodeKind::select && (others || before_means))
      fail_usage(
          "verify: the stage '{}' leaves out rows after other stages, and a sample of the input does not tell which; "
          "verify the output of the stages before it.",
          node.stage);
    if (leaves_means(node)) {
      before_means = open_again();
      select_kept_rows(*before_means, first, options.memory_bytes, options.progress);
      first.push_back(std::make_shared<Voxel>(means->size(), VoxelKeep::center));
    } else if (node.kind == NodeKind::select) {
      first.push_back(node.op);
    }
    others |= node.kind != NodeKind::select;
  }
  select_kept_rows(cloud, first, options.memory_bytes, options.progress);
  return before_means;
}

}  // namespace pointsweep
