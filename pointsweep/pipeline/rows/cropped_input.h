// SPDX-License-Identifier: MIT
/// The parts of the input that a chain reads, with row numbers if it reads them.
#pragma once

#include <cstdint>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// Returns the cloud without the nodes of levels of detail whose box lies outside of the region that the first stages
/// of the plan keep (SelectOperator::extent()). The boxes of nodes of COPC files are trusted; boxes of other chunks are
/// not. If a stage of the chain reads row numbers, the cloud has all nodes.
InputCloud cropped_input(const InputCloud& cloud, const ChainPlan& plan);
/// Returns cropped_input(), with row numbers if a stage reads them. `first`: the number of the first row.
InputCloud input_of_chain(const InputCloud& cloud, const ChainPlan& plan, std::uint64_t first = 0);

}  // namespace pointsweep
