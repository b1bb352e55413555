// SPDX-License-Identifier: MIT
/// Applies the rule of a plan to neighbourhoods that have been found and certified, before any stage sees them.
/// Without a rule nothing is done.
#pragma once

#include "pointsweep/search/cell_search.h"
#include "pointsweep/sweep/plan.h"

namespace pointsweep {

/// Leaves of the list of each of the `size` points of `own` what the rule keeps; the lists refer to `slots`.
void truncate_lists(const SweepPlan& plan, const PointColumns& own, std::size_t size, const PointColumns* slots,
                    CellNeighbors& lists);

}  // namespace pointsweep
