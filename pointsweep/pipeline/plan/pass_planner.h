// SPDX-License-Identifier: MIT
/// Plans one pass of a chain for the sweep: nodes of the graph become stages, and versions become numbered columns.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// Fills the plan, columns and fields of `pass`, whose `input` is the cloud as the pass sees it, with the nodes of
/// `scheduled`. `carried`: attributes carried into this pass. `first_stage`: number of stages in earlier passes.
/// `kept`: names of the attributes that the pass makes and keeps.
void plan_columns(const ChainGraph& graph, const ScheduledPass& scheduled, const std::vector<Attribute>& carried,
                  std::size_t first_stage, const std::vector<std::string>& kept, PlannedPass& pass);

}  // namespace pointsweep
