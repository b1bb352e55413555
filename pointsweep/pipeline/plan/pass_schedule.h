// SPDX-License-Identifier: MIT
/// The pass in which each node of a chain runs, and the plan of one pass for the sweep.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pointsweep/pipeline/plan/chain_graph.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

enum class PassKind : std::uint8_t {
  sweep,  ///< finds neighbourhoods
  rows,   ///< reads the rows in their order: its stages look at their own point only
  order,  ///< puts the points in order, by position or by place, for an InOrderOperator
};

/// A pass of which only the nodes are known.
struct ScheduledPass {
  PassKind kind = PassKind::sweep;
  std::size_t neighborhood = 0;      ///< the node that says which
  std::vector<std::size_t> stages;   ///< nodes with an operator, in their order
  std::vector<std::size_t> reduces;  ///< nodes whose values are known when the pass has ended
  bool selects = false;
  bool connects = false;  ///< one of its stages emits edges; what that one makes is known when the pass has ended
};

/// Takes the nodes of a graph one after another. Each comes into the first pass in which every attribute and every
/// value it reads is known, no later stage having remade one; a select and a new neighbourhood end all passes before
/// them. So two values that do not depend on each other are found by one pass.
class PassSchedule {
 public:
  explicit PassSchedule(const ChainGraph& graph);
  /// Throws UsageError for a stage that would need the neighbours of a pass that has ended.
  std::vector<ScheduledPass> passes();

 private:
  /// When an attribute was made and last read, by number of the pass.
  struct Use {
    std::size_t made = 0, read = 0;
    bool is_made = false;  ///< by a stage of this segment
  };
  void add(std::size_t node);
  void add(std::size_t node, const StageOperator& op);
  void add_stage(std::size_t node, const StageOperator& op);
  void add_in_order(std::size_t node, const InOrderOperator& op);
  void add_select(std::size_t node);
  void end_rows_with(ScheduledPass& pass, std::size_t node);
  std::size_t earliest(const Contract& contract) const;
  std::size_t pass_for(const StageOperator& op, const Contract& contract, std::size_t earliest);
  bool takes(const ScheduledPass& pass, const StageOperator& op) const;
  std::size_t find_input_value();
  std::size_t find_value(const Reduction& reduction);
  std::size_t known_after_values(const std::vector<std::size_t>& reduces);
  void require_search_positions(const StageOperator& op, std::size_t pass) const;
  std::size_t known_after(const Reduction& reduction) const;
  void note_use(const Contract& contract, std::size_t pass, std::size_t made);
  ScheduledPass& new_pass(PassKind kind);
  void begin_segment();

  const ChainGraph& graph_;
  std::size_t neighborhood_ = 0;
  std::vector<ScheduledPass> passes_;
  std::size_t segment_ = 0;                      ///< first pass after the last select or renewal
  std::map<std::string, Use> used_;              ///< in this segment, by attribute
  std::map<std::size_t, std::size_t> value_of_;  ///< by reduce node, the pass whose end tells its value
};

/// Fills the plan, columns and fields of a pass.
class PassPlanner {
 public:
  /// `carried`: from the pass before into this one. `first_stage`: number of its first stage in the chain, from 0 on.
  /// `pass.input` is the cloud as the pass sees it. All must outlive this.
  PassPlanner(const ChainGraph& graph, const std::vector<Attribute>& carried, std::size_t first_stage,
              PlannedPass& pass);
  void add_neighborhood(std::size_t node);
  void add_stage(std::size_t node);
  /// After the last stage: `kept` are the names of what the pass makes and keeps.
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
  std::vector<std::size_t> made_;  ///< versions, the last of each attribute, in the order first made
  std::map<std::uint16_t, std::size_t> made_in_step_;  ///< by column
};

}  // namespace pointsweep
