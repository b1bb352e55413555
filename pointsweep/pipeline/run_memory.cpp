// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/run_memory.h"

#include <algorithm>
#include <thread>

#include "pointsweep/pipeline/radius_estimate.h"
#include "pointsweep/pipeline/row_mask.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kMovedPositionBytes = 3 * sizeof(double);

/// Of a point, the most at once: while a pass ends, what came into it and what goes out of it.
std::uint64_t most_carried(const PlannedSweeps& planned) {
  std::uint64_t most = 0, before = 0;
  for (const PlannedSweep& sweep : planned.sweeps) {
    const bool stays = planned.reorders || sweep.selects || &sweep != &planned.sweeps.back();
    std::uint64_t after = 0;
    for (const Attribute& a : sweep.carried) after += stays ? a.bytes() : 0;
    most = std::max(most, before + after);
    before = after;
  }
  return most;
}

bool in_memory(const MemoryPlan& plan) { return !plan.spill_stream && !plan.spill_results; }

MemoryDemand demand(std::uint64_t record_bytes, std::uint64_t result_bytes, std::uint64_t points, const Survey& survey,
                    const RunOptions& options) {
  const std::uint64_t row_bytes = points >> 32 ? 8 : 4;
  return {
      .points = points,
      .working_record_bytes = record_bytes + row_bytes,
      .result_record_bytes = result_bytes,
      .slab_points = options.slab_points != 0 ? options.slab_points : recommended_slab_points(points, survey.dimension),
      .threads = options.threads != 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency()),
      .cell_points = options.cell_points};
}

/// What a radius without a limit k adds to the demand, and what it means for the user.
Effort add_radius(MemoryDemand& demand, const SweepPlan& plan, const Survey& survey) {
  const Neighborhood& n = plan.neighborhood;
  if (n.k != Neighborhood::kUnlimited) return {};
  const double width = n.radius * static_cast<double>(plan.step_count() + 1);
  const RadiusEstimate estimate = estimate_radius(survey, demand.points, n.radius, width);
  demand.slice_points = estimate.slice_points;
  demand.most_neighbors = static_cast<std::uint64_t>(estimate.most_neighbors);
  const double all = estimate.neighbors * static_cast<double>(demand.points);
  return {estimate.neighbors, neighbor_seconds(plan, all) / demand.threads};
}

MemoryPlan plan(std::uint64_t budget, const SweepPlan& sweep, const MemoryDemand& demand, const RunOptions& options) {
  MemoryPlan memory = try_plan_memory(budget, sweep, demand);
  if (options.spill || !options.resume_folder.empty()) {
    memory.spill_stream = memory.spill_results = true;
    memory.result_buffer_bytes = std::max<std::uint64_t>(memory.result_buffer_bytes, 1 << 20);
  }
  return memory;
}

/// Points that are put in order and go through no stage.
SweepPlan unswept(std::uint32_t result_bytes) {
  SweepPlan none;
  none.steps = {0, 0};
  none.result_bytes = result_bytes;
  return none;
}

/// Reads rows in their order: a megabyte of them at once.
MemoryPlan plan_rows() {
  MemoryPlan memory;
  memory.expected_bytes = kFixedBytes;
  return memory;
}

/// The masks of the select before and of the one that is decided.
std::uint64_t mask_bytes(const PlannedSweeps& planned, std::uint64_t points) {
  return planned.selects() ? 2 * RowMask::bytes(points) : 0;
}

std::uint64_t travelling_bytes(const PlannedSweep& sweep) {
  const PositionFields p = position_fields(sweep.input, "The input");
  return size_of(p.x.type) + size_of(p.y.type) + size_of(p.z.type) + 8 * sweep.chain.payload(sweep.input).size();
}

}  // namespace

bool RunMemory::spills() const {
  return spill_rows || !in_memory(reordering) || !std::ranges::all_of(sweeps, in_memory);
}

RunMemory plan_run_memory(std::uint64_t budget, const PlannedSweeps& planned, std::uint64_t points,
                          const Survey& survey, const RunOptions& options, std::uint64_t output_bytes) {
  RunMemory memory;
  for (const PlannedSweep& sweep : planned.sweeps) {
    if (sweep.kind == PassKind::rows) {
      memory.efforts.emplace_back();
      memory.record_bytes.push_back(sweep.input.stride);
      memory.sweeps.push_back(plan_rows());
      continue;
    }
    SweepPlan stages = sweep.chain.plan;
    if (sweep.kind == PassKind::order) stages = unswept(sweep.chain.plan.result_bytes);
    const bool whole = leaves_in_order(planned, options) && &sweep == &planned.sweeps.back();
    MemoryDemand needs = demand(whole ? sweep.input.stride : travelling_bytes(sweep),
                                whole ? output_bytes : stages.result_bytes, points, survey, options);
    memory.efforts.push_back(add_radius(needs, stages, survey));
    memory.record_bytes.push_back(needs.working_record_bytes);
    memory.sweeps.push_back(plan(budget, stages, needs, options));
    memory.expected_bytes = std::max(memory.expected_bytes, memory.sweeps.back().expected_bytes);
  }
  if (planned.reorders) {
    memory.reordering = plan_ordering_memory(budget, output_bytes + kMovedPositionBytes, points, survey, options);
    memory.expected_bytes = std::max(memory.expected_bytes, memory.reordering.expected_bytes);
  }
  std::uint64_t needed = memory.reordering.needed_bytes;
  for (const MemoryPlan& sweep : memory.sweeps) needed = std::max(needed, sweep.needed_bytes);
  if (needed != 0) fail_budget(budget, needed);
  memory.row_bytes = points * most_carried(planned) + mask_bytes(planned, points);
  memory.spill_rows = memory.row_bytes > 0 && (memory.spills() || memory.expected_bytes + memory.row_bytes > budget);
  if (!memory.spill_rows) memory.expected_bytes += memory.row_bytes;
  return memory;
}

MemoryPlan plan_ordering_memory(std::uint64_t budget, std::uint64_t record_bytes, std::uint64_t points,
                                const Survey& survey, const RunOptions& options) {
  return plan(budget, unswept(0), demand(record_bytes, 0, points, survey, options), options);
}

bool leaves_in_order(const PlannedSweeps& planned, const RunOptions& options) {
  return options.order == Order::sweep && !planned.reorders;
}

}  // namespace pointsweep
