// SPDX-License-Identifier: MIT
/// The steps by which plan_chain() plans the passes over the cloud: the schedule, which decides in which pass each node
/// of the graph runs, and the stages and columns of each pass.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// A pass as a list of its nodes, without columns and steps.
struct ScheduledPass {
  PassKind kind = PassKind::sweep;
  std::size_t neighborhood = 0;      ///< the node that defines the neighbourhoods
  std::vector<std::size_t> stages;   ///< nodes with an operator, in their order
  std::vector<std::size_t> reduces;  ///< nodes whose values are known when the pass has ended
  bool selects = false;
  bool connects = false;  ///< one of its stages emits edges; the attributes of that stage are known after the pass
};

/// Assigns the operators and reductions of a graph to passes, one after another. An in-order operator gets a pass of
/// its own, and a select runs in the last pass of its segment. Each other node goes to the first pass in which every
/// attribute and value that it reads is known, but to no pass before the last one in which an earlier node reads an
/// attribute that the node changes. So one pass computes several independent values. A stage that drops rows, or a new
/// neighbourhood, ends a segment: the nodes after it run in later passes than the nodes before it. For example, these
/// are the passes of
/// `normals | sor | curvature | where(outlier == 0) | reneighbor | normals`:
///
///   0, a sweep: normals, mean_distance (a part of sor), curvature; at its end, statistics of mean_distance are known
///   1, rows:    outlier (the other part of sor), where
///   2, a sweep: normals, with the new neighbourhoods
///
/// Throws UsageError for a stage that needs the neighbours which points had before an earlier pass moved them.
std::vector<ScheduledPass> schedule_passes(const ChainGraph& graph);

/// Fills `plan`, `nodes`, `columns`, `file_fields` and `made` of `pass`, whose `input` is the cloud as the pass sees
/// it, with the nodes of `scheduled`. `carried`: attributes carried into this pass. `first_stage`: number of stages in
/// earlier passes. `kept`: names of the attributes that the pass makes and keeps.
void plan_columns(const ChainGraph& graph, const ScheduledPass& scheduled, const std::vector<Attribute>& carried,
                  std::size_t first_stage, const std::vector<std::string>& kept, PlannedPass& pass);

}  // namespace pointsweep
