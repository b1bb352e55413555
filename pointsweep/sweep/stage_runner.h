// SPDX-License-Identifier: MIT
/// Applies the stages of a step to a batch of points whose neighbourhoods are known.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "pointsweep/points/degenerate_points.h"
#include "pointsweep/points/degenerate_rows.h"
#include "pointsweep/row_error.h"
#include "pointsweep/sweep/distance_histogram.h"
#include "pointsweep/sweep/edge_emitter.h"
#include "pointsweep/sweep/plan.h"

namespace pointsweep {

/// Times, degenerate points and errors of the stages that one thread ran.
struct StageTally {
  std::vector<double> seconds;           ///< by stage
  std::vector<DegeneratePoints> marked;  ///< by stage, those of the step that was run last: points of its batch
  /// By stage: the rows of marked points whose results are final. Callers of run_step() add these rows.
  std::vector<DegenerateRows> degenerate;
  FirstRowError refused;                         ///< by a stage that cannot make the value of a row; ends the pass
  std::unique_ptr<NeighborDistances> distances;  ///< filled if not null
  std::unique_ptr<EdgeEmitter> edges;            ///< takes the edges of a connecting stage if not null
};

/// A batch as the stages see it. `own_columns` are the columns of the batch itself, which a stage both reads and fills.
struct Batch {
  PointColumns own;  ///< own.columns = own_columns.data()
  std::size_t size = 0;
  const PointColumns* slots = nullptr;
  const std::uint32_t* begin = nullptr;
  const NeighborRef* refs = nullptr;
  std::byte* const* made = nullptr;  ///< writable columns by column number
};

/// Calls `use(stage, point of the batch)` for each point that a stage of `step` has marked. `step` must be the step
/// that was run last.
template <class Use>
void for_each_marked(const SweepPlan& plan, std::size_t step, const StageTally& tally, Use use) {
  for (std::size_t s = plan.steps[step]; s < plan.steps[step + 1]; ++s)
    tally.marked[s].for_each([&](std::size_t i) { use(s, i); });
}

/// Applies stage `s` of the plan to the batch.
void run_stage(const SweepPlan& plan, std::size_t s, const Batch& batch, StageTally& tally);

void run_step(const SweepPlan& plan, std::size_t step, const Batch& batch, StageTally& tally);

/// Copies the result columns of the batch into result records.
void collect_results(const SweepPlan& plan, const std::byte* const* columns, std::size_t size,
                     std::vector<std::byte>& results);

}  // namespace pointsweep
