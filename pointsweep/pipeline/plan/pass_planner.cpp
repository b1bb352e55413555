// SPDX-License-Identifier: MIT
/// The stages and columns of one pass: plan_columns().
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "pointsweep/pipeline/plan/pass_schedule.h"

namespace pointsweep {
namespace {

/// Turns nodes of the graph into stages, and versions into numbered columns, one node after another.
class PassPlanner {
 public:
  PassPlanner(const ChainGraph& graph, const std::vector<Attribute>& carried, std::size_t first_stage,
              PlannedPass& pass)
      : graph_(graph), carried_(carried), first_stage_(first_stage), pass_(pass), plan_(pass.plan) {
    plan_.steps = {0};
  }

  /// Plans the neighbourhood of the pass. A rule of the neighbourhood reads the values that attributes have before the
  /// first stage of the pass.
  void add_neighborhood(std::size_t node) {
    plan_.neighborhood = *graph_.nodes[node].neighborhood();
    if (!plan_.neighborhood.rule) return;
    for (const Attribute& a : plan_.neighborhood.rule->reads()) plan_.rule_reads.push_back(file_column(a));
  }

  void add_stage(std::size_t number) {
    const GraphNode& node = graph_.nodes[number];
    const StageOperator& op = *node.op();
    Stage stage{.op = op, .reads = {}, .reads_neighbors = {}, .makes = {}};
    stage.position = column_moved_to(node);
    for (const std::size_t v : node.reads) stage.reads.push_back(column_of(v));
    for (const std::size_t v : node.reads_neighbors) stage.reads_neighbors.push_back(column_of(v));
    // A stage that uses neighbours reads their moved positions if an earlier stage of the pass has moved the points.
    // So, after a stage that moves points in this step, it begins a new step, which waits until the neighbours have
    // moved.
    const bool sees_moved = contract_of(op).default_k > 0 && stage.position >= 0 &&
                            made_in_this_step(static_cast<std::uint16_t>(stage.position));
    const auto is_new = [&](std::uint16_t column) { return made_in_this_step(column); };
    if (sees_moved || std::ranges::any_of(stage.reads_neighbors, is_new)) plan_.steps.push_back(plan_.stages.size());
    const std::string maker = fmt::format("{} {}", first_stage_ + plan_.stages.size() + 1, name_of(op));
    for (const std::size_t v : node.makes) {
      const Attribute& a = graph_.versions[v].attribute;
      stage.makes.push_back(column_of_version_[v] = new_column(a, maker));
      made_in_step_[stage.makes.back()] = plan_.steps.size() - 1;
      const auto same = [&](std::size_t other) { return graph_.versions[other].attribute.name == a.name; };
      const auto known = std::ranges::find_if(made_, same);
      known == made_.end() ? made_.push_back(v) : void(*known = v);
    }
    note_step_of(stage);
    pass_.nodes.push_back(number);
    plan_.stages.push_back(std::move(stage));
  }

  void finish(const std::vector<std::string>& kept) {
    plan_.steps.push_back(plan_.stages.size());
    find_results(kept);
    find_lifetimes();
  }

 private:
  /// Returns the column of the moved positions that a stage sees; -1 if no earlier stage of the pass moves points.
  int column_moved_to(const GraphNode& node) const {
    if (!node.position) return -1;
    const auto column = column_of_version_.find(*node.position);
    return column != column_of_version_.end() && made_in_step_.contains(column->second) ? column->second : -1;
  }

  void note_step_of(const Stage& stage) {
    const auto note = [&](std::uint16_t column) { pass_.columns[column].last_step = plan_.steps.size() - 1; };
    for (const auto* columns : {&stage.reads, &stage.reads_neighbors, &stage.makes})
      std::ranges::for_each(*columns, note);
    if (stage.position >= 0) note(static_cast<std::uint16_t>(stage.position));
  }

  std::uint16_t new_column(const Attribute& attribute, std::string made_by) {
    const auto bytes = static_cast<std::uint32_t>(attribute.bytes());
    plan_.column_bytes.push_back(bytes);
    pass_.columns.push_back({.attribute = attribute.name, .made_by = std::move(made_by), .bytes = bytes});
    return static_cast<std::uint16_t>(plan_.column_bytes.size() - 1);
  }

  /// Returns a new column with an attribute that the cloud has when the pass begins.
  std::uint16_t file_column(const Attribute& attribute) {
    std::vector<std::string> fields;
    for (const std::string& name : attribute.fields)
      fields.push_back(pass_.input.fields[field_meant(pass_.input, name).value()].name);
    const bool is_carried = std::ranges::find(carried_, attribute.name, &Attribute::name) != carried_.end();
    const std::uint16_t column = new_column(attribute, is_carried ? "a pass before" : "the file");
    plan_.file_columns.push_back({column, {}, attribute.type});
    pass_.file_fields.push_back(std::move(fields));
    return column;
  }

  std::uint16_t column_of(std::size_t version) {
    const auto known = column_of_version_.find(version);
    if (known != column_of_version_.end()) return known->second;
    return column_of_version_[version] = file_column(graph_.versions[version].attribute);
  }

  bool made_in(std::size_t step, std::uint16_t column) const {
    const auto made = made_in_step_.find(column);
    return made != made_in_step_.end() && made->second == step;
  }
  bool made_in_this_step(std::uint16_t column) const { return made_in(plan_.steps.size() - 1, column); }

  void find_results(const std::vector<std::string>& kept) {
    for (const std::size_t v : made_) {
      const Attribute& a = graph_.versions[v].attribute;
      if (std::ranges::find(kept, a.name) == kept.end()) continue;
      const std::uint16_t column = column_of_version_.at(v);
      plan_.results.push_back({column, plan_.result_bytes, pass_.columns[column].bytes});
      plan_.result_bytes += pass_.columns[column].bytes;
      pass_.made.push_back(a);
      pass_.columns[column].written = true;
      pass_.columns[column].last_step = plan_.step_count() - 1;
    }
  }

  /// Derives the lifetime of each column from its readers.
  void find_lifetimes() {
    plan_.lifetimes.assign(plan_.column_bytes.size(), Lifetime::none);
    for (const FileColumn& file : plan_.file_columns) plan_.lifetimes[file.column] = Lifetime::cell;
    for (const ResultColumn& result : plan_.results) read_in_step(result.column, plan_.step_count() - 1);
    for (std::size_t step = 0; step < plan_.step_count(); ++step) {
      for (std::size_t s = plan_.steps[step]; s < plan_.steps[step + 1]; ++s) {
        const Stage& stage = plan_.stages[s];
        for (const std::uint16_t column : stage.reads) read_in_step(column, step);
        for (const std::uint16_t column : stage.reads_neighbors) plan_.lifetimes[column] = Lifetime::cell;
        if (stage.position >= 0) plan_.lifetimes[static_cast<std::size_t>(stage.position)] = Lifetime::cell;
      }
    }
  }

  void read_in_step(std::uint16_t column, std::size_t step) {
    const Lifetime needed = made_in(step, column) ? Lifetime::step : Lifetime::cell;
    plan_.lifetimes[column] = std::max(plan_.lifetimes[column], needed);
  }

  const ChainGraph& graph_;
  const std::vector<Attribute>& carried_;
  std::size_t first_stage_;
  PlannedPass& pass_;
  SweepPlan& plan_;
  std::map<std::size_t, std::uint16_t> column_of_version_;
  std::vector<std::size_t> made_;  ///< last version of each attribute that the pass makes, in the order first made
  std::map<std::uint16_t, std::size_t> made_in_step_;  ///< for each made column, the step that makes it
};

}  // namespace

void plan_columns(const ChainGraph& graph, const ScheduledPass& scheduled, const std::vector<Attribute>& carried,
                  std::size_t first_stage, const std::vector<std::string>& kept, PlannedPass& pass) {
  PassPlanner planner(graph, carried, first_stage, pass);
  planner.add_neighborhood(scheduled.neighborhood);
  for (const std::size_t node : scheduled.stages) planner.add_stage(node);
  planner.finish(kept);
}

}  // namespace pointsweep
