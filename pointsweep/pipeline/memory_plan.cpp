// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/memory_plan.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include "pointsweep/error.h"

namespace pointsweep {

namespace {

/// A point in the window: coordinates, row, place, its share of boxes, columns and, where later steps need them, lists.
std::uint64_t window_point_bytes(const SweepPlan& plan) {
  std::uint64_t bytes = 3 * 8 + 8 + 4 + 4 + plan.lasting_bytes();
  if (plan.step_count() > 1) bytes += 4 + 4 * std::min<std::size_t>(plan.neighborhood.k, 1024);
  return bytes;
}

/// Slabs that are in memory at once: the one searched, its neighbours on both sides and those read ahead.
std::uint64_t window_slabs(const SweepPlan& plan, unsigned threads) {
  return 3 + plan.step_count() + std::max(1u, threads / 2);
}

/// What the cells of the window are expected to take, lists included.
std::uint64_t cells_bytes(const SweepPlan& plan, std::uint64_t slab_points, const MemoryDemand& demand) {
  return std::min(demand.points, window_slabs(plan, demand.threads) * slab_points) * window_point_bytes(plan);
}

/// The same and what threads have in hand.
std::uint64_t window_bytes(const SweepPlan& plan, std::uint64_t slab_points, const MemoryDemand& demand) {
  const std::uint64_t points = demand.points;
  const std::uint64_t loading = std::min(points, slab_points) * (demand.working_record_bytes + 3 * 8 + 8 + 4 + 16);
  // Each thread has a cell in hand: its lists, what is made of them, the candidates of a point.
  const std::uint64_t listed =
      plan.neighborhood.k == Neighborhood::kUnlimited ? 1024 : std::min<std::uint64_t>(plan.neighborhood.k, points);
  const std::uint64_t in_hand =
      std::min<std::uint64_t>(points, 1024) * (4 * listed + 2 * plan.result_bytes + plan.passing_bytes()) +
      128 * listed;
  return cells_bytes(plan, slab_points, demand) + std::max(1u, demand.threads) * (loading + in_hand);
}

std::uint64_t limit_of_control_group() {
  std::uint64_t limit = std::numeric_limits<std::uint64_t>::max();
  for (const char* path : {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::ifstream file(path);
    std::uint64_t bytes;
    if (file >> bytes) limit = std::min(limit, bytes);
  }
  return limit;
}

constexpr std::uint64_t kLeastSlabPoints = 4096;
constexpr std::uint64_t kLeastBuffer = 4096;

MemoryPlan divide(std::uint64_t budget, const SweepPlan& plan, const MemoryDemand& demand) {
  const std::uint64_t stream = demand.points * demand.working_record_bytes;
  const std::uint64_t results = demand.points * demand.result_record_bytes;
  MemoryPlan out;
  out.slab_points = demand.slab_points;
  // For chunks on their way to their slabs, also where these are in memory.
  out.stream_buffer_bytes = std::clamp<std::uint64_t>(budget / 8, 8 << 20, 64 << 20);
  out.recall_bytes = std::max<std::uint64_t>(1 << 20, budget / 8);
  out.window_bytes = window_bytes(plan, out.slab_points, demand);
  const auto fits = [&](std::uint64_t bytes) { return kFixedBytes + out.window_bytes + bytes <= budget; };
  if (fits(stream + results + out.stream_buffer_bytes)) {
    out.expected_bytes = kFixedBytes + out.window_bytes + stream + results + out.stream_buffer_bytes;
    return out;
  }
  // Buffers for spilling take an eighth each; the window may take half of what the fixed part leaves.
  const auto slabs = [&] { return demand.points / std::max<std::uint64_t>(out.slab_points, 1) + 1; };
  out.result_buffer_bytes = std::max<std::uint64_t>(budget / 8, 1 << 20);
  if (fits(stream + out.stream_buffer_bytes + out.result_buffer_bytes)) {
    out.spill_results = true;
    out.expected_bytes = kFixedBytes + out.window_bytes + stream + out.stream_buffer_bytes + out.result_buffer_bytes;
    return out;
  }
  out.spill_stream = true;
  out.stream_buffer_bytes = std::max(budget / 8, slabs() * kLeastBuffer);
  out.spill_results = !fits(results + out.stream_buffer_bytes);
  while (!fits(out.stream_buffer_bytes + (out.spill_results ? out.result_buffer_bytes : results)) &&
         out.slab_points > kLeastSlabPoints) {
    out.slab_points = std::max(kLeastSlabPoints, out.slab_points / 2);
    out.window_bytes = window_bytes(plan, out.slab_points, demand);
    out.stream_buffer_bytes = std::max(budget / 8, slabs() * kLeastBuffer);
  }
  const std::uint64_t spilling = out.stream_buffer_bytes + (out.spill_results ? out.result_buffer_bytes : results);
  out.expected_bytes = kFixedBytes + out.window_bytes + spilling;
  if (out.expected_bytes > budget) {
    // What the buffers take grows with the budget: an eighth each.
    out.needed_bytes = (kFixedBytes + out.window_bytes + (2u << 20)) * 4 / 3 + slabs() * kLeastBuffer;
  }
  return out;
}

}  // namespace

void fail_budget(std::uint64_t budget, std::uint64_t needed_bytes) {
  fail("A memory budget of {} MB is too small for this cloud and chain: give --memory {}M or more.", budget >> 20,
       std::max((needed_bytes >> 20) + 1, (budget >> 20) + 1));
}

MemoryPlan plan_memory(std::uint64_t budget, const SweepPlan& plan, const MemoryDemand& demand) {
  MemoryPlan out = try_plan_memory(budget, plan, demand);
  if (out.needed_bytes != 0) fail_budget(budget, out.needed_bytes);
  return out;
}

MemoryPlan try_plan_memory(std::uint64_t budget, const SweepPlan& plan, const MemoryDemand& demand) {
  MemoryPlan out = divide(budget, plan, demand);
  const std::uint64_t others = out.expected_bytes - cells_bytes(plan, out.slab_points, demand);
  // An eighth is lost between allocations.
  out.cells_bytes = (budget - std::min(budget, others)) / 8 * 7;
  return out;
}

std::uint64_t available_memory() {
  std::ifstream file("/proc/meminfo");
  std::uint64_t available = std::uint64_t{1} << 30;
  for (std::string word; file >> word;) {
    if (word == "MemAvailable:" && file >> available) {
      available *= 1024;
      break;
    }
  }
  return std::min(available, limit_of_control_group());
}

std::uint64_t default_memory_budget() { return available_memory() / 2; }

}  // namespace pointsweep
