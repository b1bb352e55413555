// SPDX-License-Identifier: MIT
/// Decides in which pass over the cloud each node of a chain runs.
#pragma once

#include <cstddef>
#include <cstdint>
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
///
/// Throws UsageError for a stage that needs the neighbours which points had before an earlier pass moved them.
std::vector<ScheduledPass> schedule_passes(const ChainGraph& graph);

}  // namespace pointsweep
