// SPDX-License-Identifier: MIT
/// A run by the paper's own algorithm (reference/) instead of the engine.
#pragma once

#include <cstdint>
#include <functional>

#include "pointsweep/order/row_store.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/output_layout.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/pipeline/statistics.h"
#include "pointsweep/sweep/sweep.h"

namespace pointsweep {

/// Throws UsageError for a request that the paper's algorithm has no answer to.
void require_reference_can(const EngineOptions& options);

struct ReferenceRun {
  const Stream& stream;  ///< in canonical order
  const PlannedPass& pass;
  RowStore& store;             ///< receives result records by input row,
  const OutputLayout* layout;  ///< or, if not null, whole records by place in the stream
  std::uint64_t memory_bytes;  ///< for the active set
  std::function<void(std::uint64_t points_read, std::uint64_t points_active)> progress;
};

/// What the sweep would tell of itself; what only the reference tells is added to `counts`.
SweepStatistics run_reference(const ReferenceRun& run, ReferenceCounts& counts);

}  // namespace pointsweep
