// SPDX-License-Identifier: MIT
/// Engines that can replace the library's sweep for a pass, such as the reference engine. The library itself registers
/// none; a program registers the engines that it links.
#pragma once

#include <cstdint>
#include <functional>

#include "pointsweep/order/row_store.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/pipeline/plan/output_layout.h"
#include "pointsweep/sweep/sweep.h"

namespace pointsweep {

/// The pass that an engine performs.
struct EnginePass {
  const Stream& stream;  ///< in canonical order
  const PlannedPass& pass;
  /// Receives result records by input row or, if `layout` is not null, whole output records by place in the stream.
  RowStore& store;
  const OutputLayout* layout;  ///< layout of output records; null if `store` receives result records
  std::uint64_t memory_bytes;  ///< limit for the points that the engine holds
  std::function<void(std::uint64_t points_read, std::uint64_t points_active)> progress;
};

class SweepEngine {
 public:
  virtual ~SweepEngine() = default;
  /// Throws UsageError for a request that the engine does not support.
  virtual void require_can(const ChainPlan& plan, const EngineOptions& options) const = 0;
  /// Performs the pass and returns the statistics of its sweep. Adds to `statistics` the counts that only this engine
  /// has.
  virtual SweepStatistics sweep(const EnginePass& pass, Statistics& statistics) const = 0;
};

/// Registers `made`, which must outlive all runs.
void register_engine(Engine engine, const SweepEngine& made);

/// Returns the engine; null for Engine::exact. Throws UsageError if the program has not registered it.
const SweepEngine* engine_of(Engine engine);

}  // namespace pointsweep
