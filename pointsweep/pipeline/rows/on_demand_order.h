// SPDX-License-Identifier: MIT
/// Decides whether the points of a run can be put in order on demand: by the boxes of its inputs, without a
/// distribution pass.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// The decision about an order on demand, made before the first pass reads a point. The boxes only serve this decision:
/// the run counts the points before it relies on their places (Stream::on_demand).
struct OnDemandOrder {
  std::string why_not;        ///< reason against an order on demand, as the end of a sentence; empty if it is possible
  std::vector<RowBox> boxes;  ///< boxes that the inputs state for all rows, by ascending row
};

/// Returns the number of the first pass of `planned` that puts points in order; the number of passes if none does.
std::size_t first_ordered_pass(const ChainPlan& planned);

/// Decides whether the first pass that puts points in order can do so on demand.
OnDemandOrder on_demand_order(const InputCloud& cloud, const ChainPlan& planned, const EngineOptions& options);

}  // namespace pointsweep
