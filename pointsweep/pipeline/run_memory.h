// SPDX-License-Identifier: MIT
/// What the phases of a run ask of the memory plan.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/formats/input_cloud.h"
#include "pointsweep/order/survey.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/memory_plan.h"
#include "pointsweep/pipeline/on_demand_order.h"
#include "pointsweep/pipeline/plan/chain_plan.h"

namespace pointsweep {

/// What a radius without a limit k asks for, estimated. All 0 where there is a limit.
struct Effort {
  double neighbors_per_point = 0;
  double seconds = 0;  ///< of search and operators, on all threads
};

/// Of all phases, decided before the first.
struct RunMemory {
  std::vector<MemoryPlan> passes;  ///< by pass
  std::size_t ordered_pass = 0;    ///< first_ordered_pass()
  /// Of that pass, where it is to be put in order on demand and turns out not to fit.
  std::optional<MemoryPlan> by_distribution;
  std::string order_text;                   ///< how the points of that pass are put in order, and why
  std::vector<std::uint64_t> record_bytes;  ///< of a point on its way through the stream, by pass
  std::vector<Effort> efforts;              ///< by pass
  MemoryPlan reordering;                    ///< of the output, if planned.reorders
  bool spill_rows = false;                  ///< what is carried between passes, and which rows are left
  std::uint64_t row_bytes = 0;              ///< what that takes at most, in memory or in the temporary folder
  std::uint64_t expected_bytes = 0;         ///< the most at any time
  bool spills() const;
};

/// What is carried from sweep to sweep is in memory only where everything is. Throws as plan_memory(). The same survey
/// serves all sweeps: where points move is not known yet. `output_bytes`: of an output record; `codec_bytes`:
/// codec_bytes().
RunMemory plan_run_memory(std::uint64_t budget, const ChainPlan& planned, std::uint64_t points, const Survey& survey,
                          const EngineOptions& options, std::uint64_t output_bytes, std::uint64_t codec_bytes = 0,
                          const OnDemandOrder& on_demand = {"it was not looked for", {}});

/// For whole records of `record_bytes` that are only put in order. Does not throw: see MemoryPlan::needed_bytes.
MemoryPlan plan_ordering_memory(std::uint64_t budget, std::uint64_t record_bytes, std::uint64_t points,
                                const Survey& survey, const EngineOptions& options, std::uint64_t codec_bytes = 0);

/// What decoding the inputs and encoding records of `record_bytes` to these outputs takes.
std::uint64_t codec_bytes(const InputCloud& cloud, const Outputs& outputs, std::uint64_t record_bytes,
                          const EngineOptions& options);

/// The part of it for encoding one output.
std::uint64_t encoder_bytes(const Outputs& outputs, std::uint64_t record_bytes, const EngineOptions& options);

/// The order of the only sweep is the one that the output is to have: its records travel along.
bool leaves_in_order(const ChainPlan& planned, const EngineOptions& options);

}  // namespace pointsweep
