// SPDX-License-Identifier: MIT
/// Plans one pass of a chain for the sweep: nodes of the graph become stages, and versions become numbered columns.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// Fills the plan, columns and fields of a PlannedPass.
class PassPlanner {
 public:
  /// `carried`: attributes carried into this pass. `first_stage`: number of stages in earlier passes.
  /// `pass.input`: the cloud as the pass sees it. All arguments must outlive this object.
  PassPlanner(const ChainGraph& graph, const std::vector<Attribute>& carried, std::size_t first_stage,
              PlannedPass& pass);
  void add_neighborhood(std::size_t node);
  void add_stage(std::size_t node);
  /// Must be called after the last stage. `kept`: names of the attributes that the pass makes and keeps.
  void finish(const std::vector<std::string>& kept);

 private:
  std::uint16_t new_column(const Attribute& attribute, std::string made_by);
  std::uint16_t file_column(const Attribute& attribute);
  std::uint16_t column_of(std::size_t version);
  bool made_in_this_step(std::uint16_t column) const;
  int column_moved_to(const GraphNode& node) const;
  void note_step_of(const Stage& stage);
  void find_results(const std::vector<std::string>& kept);
  void find_lifetimes();
  void read_in_step(std::uint16_t column, std::size_t step);

  const ChainGraph& graph_;
  const std::vector<Attribute>& carried_;
  std::size_t first_stage_;
  PlannedPass& pass_;
  SweepPlan& plan_;
  std::map<std::size_t, std::uint16_t> column_of_version_;
  std::vector<std::size_t> made_;  ///< last version of each attribute of the pass, in the order first made
  std::map<std::uint16_t, std::size_t> made_in_step_;  ///< for each made column, the step that makes it
};

}  // namespace pointsweep
