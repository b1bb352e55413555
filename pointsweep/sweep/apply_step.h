// SPDX-License-Identifier: MIT
/// Takes points of one cell, whose neighbour lists are known, through the stages of a step. The sweep and the recall
/// share it: a value never depends on which of the two made it.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "pointsweep/sweep/worker.h"

namespace pointsweep {

/// Sets worker.columns: the columns that the step makes and that outlast it are the cell's, the others the worker's.
/// All are 0 where an operator writes nothing.
void place_columns(const SweepPlan& plan, std::uint32_t step, WindowCell& cell, Worker& worker);
/// The same without a place for columns that do not outlast the step, which stay null.
void place_cell_columns(const SweepPlan& plan, std::uint32_t step, WindowCell& cell, Worker& worker);

/// Applies the step to the points of the cell from `first` on that are not deferred; `lists` holds one list for each.
/// Notes in the cell which of them are degenerate.
/// Operators get a bounded number of neighbours at a time, so that a run can be cancelled soon.
void apply_step(const SweepPlan& plan, std::uint32_t step, WindowCell& cell, std::uint32_t first,
                const CellNeighbors& lists, const PointColumns* slots, Worker& worker);

/// Applies the step to the points `chosen` of the cell, in ascending order. After each part calls `done` with the
/// number of its first point in `chosen`; worker.chosen then holds the part with all columns, and tally.marked what of
/// it is degenerate.
void apply_step_to(const SweepPlan& plan, std::uint32_t step, const WindowCell& cell,
                   std::span<const std::uint32_t> chosen, const CellNeighbors& lists, const PointColumns* slots,
                   Worker& worker, StageTally& tally, const std::function<void(std::size_t first)>& done);

}  // namespace pointsweep
