// SPDX-License-Identifier: MIT
/// Decides in which pass over the cloud each node of a chain runs.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "pointsweep/pipeline/plan/chain_graph.h"

namespace pointsweep {

enum class PassKind : std::uint8_t {
  sweep,  ///< finds neighbourhoods
  rows,   ///< reads the rows in order; its stages read only the point itself
  order,  ///< puts the points in order for an InOrderOperator, by position or by a place that it gives (Places)
};

/// A pass as a list of its nodes, without columns and steps.
struct ScheduledPass {
  PassKind kind = PassKind::sweep;
  std::size_t neighborhood = 0;      ///< the node that defines the neighbourhoods
  std::vector<std::size_t> stages;   ///< nodes with an operator, in their order
  std::vector<std::size_t> reduces;  ///< nodes whose values are known when the pass has ended
  bool selects = false;
  bool connects = false;  ///< one of its stages emits edges; the attributes of that stage are known after the pass
};

/// Assigns the nodes of a graph to passes, one after another. Each node goes to the first pass in which every attribute
/// and value that it reads is known, but to no pass before the last one in which an earlier node reads an attribute
/// that the node changes. So one pass computes several independent values. A stage that drops rows, or a new
/// neighbourhood, ends a segment: the nodes after it run in later passes than the nodes before it. For example,
/// these are the passes of
/// `normals | sor | curvature | where(outlier == 0) | reneighbor | normals`:
///
///   0, a sweep: normals, mean_distance (a part of sor), curvature; at its end, statistics of mean_distance are known
///   1, rows:    outlier (the other part of sor), where
///   2, a sweep: normals, with the new neighbourhoods
class PassSchedule {
 public:
  explicit PassSchedule(const ChainGraph& graph);
  /// Throws UsageError for a stage that needs the neighbours which points had before an earlier pass moved them.
  std::vector<ScheduledPass> passes();

 private:
  /// The passes that can read an attribute, by number.
  struct Use {
    /// The first of these passes: the pass of the stage that makes the attribute, or the pass after it if the stage
    /// connects neighbours.
    std::size_t known_from = 0;
    std::size_t last_read = 0;  ///< last pass planned so far that reads the attribute; no earlier pass may change it
    bool is_made = false;       ///< made by a stage of this segment
  };
  void add(std::size_t node);
  void add(std::size_t node, const StageOperator& op);
  void add_stage(std::size_t node, const StageOperator& op);
  void add_in_order(std::size_t node, const InOrderOperator& op);
  void add_select(std::size_t node);
  void end_rows_with(ScheduledPass& pass, std::size_t node);
  std::size_t first_pass_for(const Contract& contract) const;
  std::size_t pass_for(const StageOperator& op, const Contract& contract, std::size_t from);
  bool takes(const ScheduledPass& pass, const StageOperator& op) const;
  std::size_t find_input_value();
  std::size_t find_value(const Reduction& reduction);
  std::size_t known_after_values(const std::vector<std::size_t>& reduces);
  void require_search_positions(const StageOperator& op, std::size_t pass) const;
  std::size_t known_after(const Reduction& reduction) const;
  void note_use(const Contract& contract, std::size_t pass, std::size_t known_from);
  ScheduledPass& new_pass(PassKind kind);
  void begin_segment();

  const ChainGraph& graph_;
  std::size_t neighborhood_ = 0;
  std::vector<ScheduledPass> passes_;
  std::size_t segment_ = 0;                      ///< first pass of the current segment
  std::map<std::string, Use> used_;              ///< by attribute, in this segment
  std::map<std::size_t, std::size_t> value_of_;  ///< for each reduce node, the pass after which its value is known
};

}  // namespace pointsweep
