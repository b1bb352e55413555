// SPDX-License-Identifier: MIT
/// The input of a run as its chain reads it: without the nodes that its first stages crop, with row numbers if a stage
/// reads them, and as a source of points for streams.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/order/source.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// Returns the cloud without the nodes of levels of detail whose box lies outside of the region that the first stages
/// of the plan keep (SelectOperator::extent()). The boxes of nodes of COPC files are trusted; boxes of other chunks are
/// not. If a stage of the chain reads row numbers, the cloud has all nodes.
InputCloud cropped_input(const InputCloud& cloud, const ChainPlan& plan);
/// Returns cropped_input(), with row numbers if a stage reads them. `first`: the number of the first row.
InputCloud input_of_chain(const InputCloud& cloud, const ChainPlan& plan, std::uint64_t first = 0);

/// Returns the points of `cloud`, which must outlive the source. Calls `note` with the number of rows after each
/// reading, from any thread.
PointSource source_of(
    InputCloud& cloud, const std::function<void(std::size_t rows)>& note = [](std::size_t) {});

}  // namespace pointsweep
