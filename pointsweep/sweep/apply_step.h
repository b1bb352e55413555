// SPDX-License-Identifier: MIT
/// Takes points of one cell, whose neighbour lists are known, through the stages of a step. The sweep and the recall
/// share it: a value never depends on which of the two made it.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "pointsweep/sweep/window_cell.h"
#include "pointsweep/sweep/worker.h"

namespace pointsweep {

/// Sets worker.columns: the columns that the step makes and that outlast it are the cell's, the others the worker's.
/// All are 0 where an operator writes nothing.
void place_columns(const SweepPlan& plan, std::uint32_t step, WindowCell& cell, Worker& worker);
/// Sets worker.columns as place_columns() does, but leaves the columns that do not outlast the step null.
void place_cell_columns(const SweepPlan& plan, std::uint32_t step, WindowCell& cell, Worker& worker);

/// Drops all lists but those with the numbers `kept`, which ascend.
void keep_lists_of(std::span<const std::uint32_t> kept, CellNeighbors& lists);

/// Applies the step to `points` of the cell; `lists` holds one list for each. Operators get a bounded number of
/// neighbours at a time, so that a run can be cancelled soon: after each part of the points, `done` is called with the
/// part, and tally.marked says which points of the part are degenerate. Chosen points are copied to worker.chosen,
/// which then holds the part with all columns.
void apply_step(const SweepPlan& plan, std::uint32_t step, const Cell& cell, const CellSubset& points,
                const CellNeighbors& lists, const PointColumns* slots, Worker& worker, StageTally& tally,
                const std::function<void(const CellSubset& part)>& done);

}  // namespace pointsweep
