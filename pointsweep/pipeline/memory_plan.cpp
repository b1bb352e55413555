// SPDX-License-Identifier: MIT
#include "pointsweep/pipeline/memory_plan.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "pointsweep/fail.h"
#include "pointsweep/order/slabs_on_demand.h"
#include "pointsweep/search/cell_search.h"
#include "pointsweep/sweep/window.h"

namespace pointsweep {
namespace {

constexpr std::uint64_t kMega = 1u << 20;
/// Returns the part of `bytes` of memory that cells may fill: an eighth is lost between allocations.
std::uint64_t fillable_bytes(std::uint64_t bytes) { return bytes / 8 * 7; }

// Bytes of structures that grow slowly with the cloud. Each constant is the size of the structure named in its comment
// on a 64-bit machine. Vectors that grow count with half of their capacity unused.

/// Bytes of a point while its slab is cut into cells: two CutPoints, the second for sparse places
/// (sweep/slab_loader.cpp).
constexpr std::uint64_t kLoadedPointBytes = 32;
/// Bytes of a thread: its stack, and the memory that the allocator keeps for it.
constexpr std::uint64_t kThreadBytes = 256 << 10;
/// Bytes of a slab in all lists with an entry for each slab: Slab, PiecedSlab, StreamPiece and SlabList of the stream,
/// entries in Frontier, and heap overhead.
constexpr std::uint64_t kSlabBytes = 640;
/// Bytes of a slab in each series of the statistics, which stores a pair of counts.
constexpr std::uint64_t kSeriesBytes = 2 * 16;
/// Bytes that remain of a dropped cell (DroppedCell), with an eighth more for growth.
constexpr std::uint64_t kDroppedCellBytes = 63;
/// Bytes of the index entry of a spilled block: Block in order/slab_store.cpp.
constexpr std::uint64_t kBlockBytes = 2 * 24;
/// Bytes of each neighbour of the point being searched: a key of 8 bytes and a NeighborRef of 4, and an eighth more for
/// candidates.
constexpr std::uint64_t kNeighborInHandBytes = 14;
/// Bytes for each of the k nearest neighbours during their search, which may hold 2 k candidates and a copy of them.
constexpr std::uint64_t kCandidateBytes = 128;
/// Bytes of the smallest and largest blocks of the spilled stream (order/stream.cpp) and of spilled results
/// (order/row_store.cpp).
constexpr std::uint64_t kLeastStreamBlock = 8192, kLeastResultBlock = 4096, kLargestBlock = 1u << 20;
constexpr std::uint64_t kMostStreamPieces = 4096;
/// Most and least memory for the lists that a thread uses at a time.
constexpr std::uint64_t kMostListBytes = 16 * kMega, kLeastListBytes = kMega / 4;

/// Returns the number of points of the thinnest slabs. With several steps, a cell waits for its neighbours, and these
/// cells wait for their neighbours; slabs thinner than some cells then save no memory, since more of them stay in the
/// window.
std::uint64_t least_slab_points(const SweepPlan& plan) { return plan.step_count() == 1 ? 4096 : 16384; }

/// Bounds of the estimated number of points in the window of a plan with several steps, measured with three steps,
/// k = 64 and the thinnest slabs: a sparse cloud with one dense place needs kUsuallyWaiting; a ball with a dense
/// middle, all of which waits for its rim, needs kMostWaiting.
constexpr std::uint64_t kUsuallyWaiting = 256 << 10, kMostWaiting = 544 << 10;

bool is_unlimited(const SweepPlan& plan) { return plan.neighborhood.k == Neighborhood::kUnlimited; }

/// Returns the bytes of the list of neighbours that a point keeps for later steps. Counts at most 1,024 neighbours.
/// Returns 0 for a single step, after which no list is needed, and without a limit k, where each step searches its
/// lists again.
std::uint64_t kept_list_bytes(const SweepPlan& plan) {
  if (plan.step_count() == 1 || is_unlimited(plan)) return 0;
  return sizeof(NeighborRef) * (1 + std::min<std::size_t>(plan.neighborhood.k, 1024));
}

std::uint64_t slabs_of(std::uint64_t slab_points, const MemoryDemand& demand) {
  return demand.points / std::max<std::uint64_t>(slab_points, 1) + 1;
}

/// Returns the average number of points of a cell of at most `cell_points`: a piece with one point more is halved.
std::uint64_t usual_cell_points(std::uint32_t cell_points) { return std::max<std::uint32_t>(cell_points, 2) * 5 / 8; }

/// Ready cells for each thread that a turn should have, so that few threads wait for the last cell of a step.
constexpr std::uint64_t kReadyCells = 8;

/// Returns the number of slabs that a turn of the sweep should read, so that each thread gets kReadyCells cells; fewer
/// are read if the budget is too small. Returns `demand.slabs_per_turn` if that is not 0.
std::uint32_t most_slabs_per_turn(std::uint64_t slab_points, const MemoryDemand& demand) {
  if (demand.slabs_per_turn != 0) return demand.slabs_per_turn;
  const std::uint64_t points = kReadyCells * demand.threads * usual_cell_points(demand.cell_points);
  const std::uint64_t slab = std::max<std::uint64_t>(slab_points, 1);
  return static_cast<std::uint32_t>(std::max<std::uint64_t>((points + slab - 1) / slab, 1));
}

/// Returns the estimated number of points in the window: in the slabs of a turn, in slabs next to them, of which there
/// are more with more steps, in the slabs read ahead, and within the radius. With several steps, the points that wait
/// for one another are added; the number is then at least kUsuallyWaiting, and the waiting points do not raise it above
/// kMostWaiting.
std::uint64_t window_points(const SweepPlan& plan, std::uint64_t slab_points, const MemoryDemand& demand,
                            std::uint32_t slabs_per_turn = 1) {
  const std::uint64_t slabs = slabs_per_turn + 2 + plan.step_count() + std::max(1u, demand.threads / 2);
  const std::uint64_t passing = slabs * slab_points + demand.slice_points;
  const std::uint64_t waiting = std::clamp(passing + demand.waiting_for_steps, kUsuallyWaiting, kMostWaiting);
  return std::min(demand.points, plan.step_count() == 1 ? passing : std::max(passing, waiting));
}

std::uint64_t cells_bytes(const SweepPlan& plan, std::uint64_t slab_points, const MemoryDemand& demand, bool lists,
                          std::uint32_t slabs_per_turn = 1) {
  return window_points(plan, slab_points, demand, slabs_per_turn) *
         (window_point_bytes(plan) + (lists ? kept_list_bytes(plan) : 0));
}

/// Returns the largest number of neighbours of a point, which is an estimate without a limit k.
std::uint64_t most_listed(const SweepPlan& plan, const MemoryDemand& demand) {
  return is_unlimited(plan) ? demand.most_neighbors : std::min<std::uint64_t>(plan.neighborhood.k, demand.points);
}

std::uint64_t neighbor_bytes(const MemoryDemand& demand) { return sizeof(NeighborRef) + demand.listed_edge_bytes; }

/// Returns whether the search gathers points and finds lists for a part of a cell at a time. Otherwise it finds the
/// lists of a whole cell at once.
bool gathers(const SweepPlan& plan) { return plan.neighborhood.k > kMostInLanes; }

/// Returns the bytes of the points around a leaf that a thread has gathered for its search.
std::uint64_t gathered_bytes(const SweepPlan& plan, const MemoryDemand& demand) {
  return gathers(plan) ? std::min<std::uint64_t>(demand.points, kMostGathered) * kGatheredPointBytes : 0;
}

/// Returns the bytes for the lists that one thread uses at a time, with the edges made from them.
std::uint64_t lists_bytes(std::uint64_t budget, const MemoryDemand& demand) {
  return std::clamp(budget / 16 / std::max(1u, demand.threads), kLeastListBytes, kMostListBytes);
}

/// Returns the memory of one thread: its stack, a slab that is being cut into cells, a cell with its results and its
/// lists, the candidates of the point that is being searched, and gathered points.
std::uint64_t thread_bytes(const SweepPlan& plan, std::uint64_t slab_points, std::uint64_t budget,
                           const MemoryDemand& demand) {
  const std::uint64_t cell = std::min<std::uint64_t>(demand.points, demand.cell_points);
  const std::uint64_t loading =
      std::min(demand.points, slab_points) * (demand.working_record_bytes + kLoadedPointBytes);
  const std::uint64_t listed = most_listed(plan, demand);
  const std::uint64_t of_cell = is_unlimited(plan) ? kMostListBytes : cell * listed * neighbor_bytes(demand);
  const std::uint64_t lists = gathers(plan) ? std::min(lists_bytes(budget, demand), of_cell) : of_cell;
  const std::uint64_t point =
      listed * ((is_unlimited(plan) ? kNeighborInHandBytes : kCandidateBytes) + demand.listed_edge_bytes);
  return kThreadBytes + loading + cell * (2 * plan.result_bytes + plan.step_lifetime_bytes()) + lists + point +
         gathered_bytes(plan, demand);
}

/// Returns the bytes that grow with the number of slabs and cells.
std::uint64_t index_bytes(const SweepPlan& plan, std::uint64_t slab_points, const MemoryDemand& demand) {
  const std::uint64_t cells = demand.points / usual_cell_points(demand.cell_points) + 1;
  return slabs_of(slab_points, demand) * (kSlabBytes + kSeriesBytes * (plan.step_count() + 2)) +
         cells * kDroppedCellBytes;
}

/// Returns the bytes of the index of a spilled stream, which has the places of its blocks in the file.
std::uint64_t stream_index_bytes(std::uint64_t slab_points, std::uint64_t buffer, const MemoryDemand& demand) {
  const std::uint64_t pieces = std::clamp<std::uint64_t>(
      std::min(slabs_of(slab_points, demand), buffer / 2 / kLeastStreamBlock), 64, kMostStreamPieces);
  const std::uint64_t block = std::clamp(buffer / 2 / (pieces + 1), kLeastStreamBlock, kLargestBlock);
  return (demand.points * demand.working_record_bytes / block + slabs_of(slab_points, demand)) * kBlockBytes;
}

/// Returns the bytes for slabs made on demand: points that wait, partly filled blocks of memory, and the index of
/// blocks of rows (order/slabs_on_demand.cpp).
std::uint64_t waiting_bytes(std::uint64_t slab_points, const MemoryDemand& demand) {
  constexpr std::uint64_t kBlockRows = 4096, kBlockIndexBytes = 80;
  return *demand.waiting_points * demand.working_record_bytes +
         slabs_of(slab_points, demand) * waiting_block_bytes(slab_points, demand.working_record_bytes) +
         demand.points / kBlockRows * kBlockIndexBytes;
}

/// Returns the bytes of a decoded block of rows and a slab under construction, for each thread.
std::uint64_t on_demand_buffer_bytes(std::uint64_t slab_points, const MemoryDemand& demand) {
  return std::max(1u, demand.threads) * (2 * kMega + slab_points * demand.working_record_bytes);
}

/// Returns the bytes of the index of spilled results. Results are spilled in buckets (order/row_store.cpp) of 1 MB if
/// the buffer has room for a block of 64 kB for each bucket, else in larger ones.
std::uint64_t result_index_bytes(std::uint64_t buffer, const MemoryDemand& demand) {
  constexpr std::uint64_t kGoodBlock = 64 << 10, kRowBytes = 4;
  const std::uint64_t bytes = demand.points * demand.result_record_bytes;
  const std::uint64_t fewest = 2 * bytes / std::max<std::uint64_t>(buffer / 2, 1) + 1;
  const std::uint64_t buckets =
      std::clamp<std::uint64_t>(bytes / kMega + 1, 1, std::max(fewest, buffer / 2 / kGoodBlock + 1));
  const std::uint64_t block = std::clamp(buffer / 2 / buckets, kLeastResultBlock, kLargestBlock);
  return demand.points * (demand.result_record_bytes + kRowBytes) / block * kBlockBytes;
}

/// Divides a budget among the structures of a pass.
class Division {
 public:
  Division(std::uint64_t budget, const SweepPlan& plan, const MemoryDemand& demand, bool lists)
      : budget_(budget), plan_(plan), demand_(demand), lists_(lists) {
    out_.slab_points = demand.slab_points;
    out_.lists_bytes = lists_bytes(budget, demand) / neighbor_bytes(demand) * sizeof(NeighborRef);
    if (!is_unlimited(plan))
      out_.threads_bytes = std::max(1u, demand.threads) * thread_bytes(plan, least_slab_points(plan), budget, demand);
    // The distribution pass needs its buffers even if the slabs stay in memory.
    out_.stream_buffer_bytes = std::clamp<std::uint64_t>(budget / 8, 8 * kMega, 64 * kMega);
  }

  /// Finds a plan. Prefers memory, then spilling, then thinner slabs. If nothing fits, the plan exceeds the budget.
  MemoryPlan find() {
    if (fits_with_results()) return out_;
    out_.spill_stream = true;
    out_.stream_buffer_bytes = std::max(budget_ / 8, kMega);
    out_.spill_results = false;
    if (fits_with_results()) return out_;
    const std::uint64_t least = least_slab_points(plan_);
    while (!fits() && out_.slab_points > least)
      out_.slab_points = std::max(least, out_.slab_points - out_.slab_points / 8);
    return out_;
  }

  /// Finds a plan for slabs on demand, with results in memory if they fit, else spilled; none if neither fits.
  std::optional<MemoryPlan> find_on_demand() {
    out_.on_demand = true;
    out_.stream_buffer_bytes = on_demand_buffer_bytes(out_.slab_points, demand_);
    return fits_with_results() ? std::optional(out_) : std::nullopt;
  }

 private:
  /// Returns whether the plan fits into the budget. Spills the results if they do not fit in memory.
  bool fits_with_results() {
    if (fits()) return true;
    out_.spill_results = true;
    out_.result_buffer_bytes = std::max(budget_ / 8, kMega);
    return fits();
  }

  bool fits() {
    const std::uint64_t threads = std::max(1u, demand_.threads);
    const std::uint64_t stream = demand_.points * demand_.working_record_bytes;
    const std::uint64_t results = demand_.points * demand_.result_record_bytes;
    out_.window_bytes = cells_bytes(plan_, out_.slab_points, demand_, lists_) +
                        threads * thread_bytes(plan_, out_.slab_points, budget_, demand_);
    out_.expected_bytes = kFixedBytes + demand_.codec_bytes + demand_.in_order_bytes +
                          std::max(out_.window_bytes, demand_.connect_bytes) +
                          index_bytes(plan_, out_.slab_points, demand_) + out_.stream_buffer_bytes;
    if (out_.on_demand)
      out_.expected_bytes += waiting_bytes(out_.slab_points, demand_);
    else
      out_.expected_bytes +=
          out_.spill_stream ? stream_index_bytes(out_.slab_points, out_.stream_buffer_bytes, demand_) : stream;
    out_.expected_bytes +=
        out_.spill_results ? out_.result_buffer_bytes + result_index_bytes(out_.result_buffer_bytes, demand_) : results;
    return out_.expected_bytes <= budget_;
  }

  std::uint64_t budget_;
  const SweepPlan& plan_;
  const MemoryDemand& demand_;
  bool lists_;  ///< true if the plan has room for all lists that later steps need; else later steps search them again
  MemoryPlan out_;
};

/// Allows more than one slab per turn if memory is left for more slabs, which is not so if slabs had to be made
/// thinner.
void add_slabs_to_turns(MemoryPlan& out, const SweepPlan& plan, const MemoryDemand& demand, bool lists) {
  if (out.slab_points < demand.slab_points) return;
  const std::uint64_t planned = cells_bytes(plan, out.slab_points, demand, lists);
  const auto more = [&] { return cells_bytes(plan, out.slab_points, demand, lists, out.slabs_per_turn) - planned; };
  out.slabs_per_turn = most_slabs_per_turn(out.slab_points, demand);
  while (out.slabs_per_turn > 1 && planned + more() > out.cells_bytes) --out.slabs_per_turn;
  out.window_bytes += more();
  out.expected_bytes += more();
}

/// Plans a pass. Prefers room for the lists of later steps over a stream in memory. If the lists do not fit beside a
/// spilled stream either, later steps search them again.
MemoryPlan divide(std::uint64_t budget, const SweepPlan& plan, const MemoryDemand& demand) {
  bool lists = true;
  MemoryPlan out = Division(budget, plan, demand, lists).find();
  if (out.expected_bytes > budget) {
    lists = false;
    out = Division(budget, plan, demand, lists).find();
  }
  const bool possible = out.expected_bytes <= budget && demand.waiting_points;
  if (possible && (out.spill_stream || out.spill_results))
    if (const auto on_demand = Division(budget, plan, demand, lists).find_on_demand()) out = *on_demand;
  std::uint64_t others = out.expected_bytes - cells_bytes(plan, out.slab_points, demand, lists);
  if (out.on_demand) {  // a reserve, since boxes give a rough estimate of the waiting points
    const std::uint64_t more = (budget - out.expected_bytes) / 2;
    out.most_waiting = *demand.waiting_points + more / demand.working_record_bytes;
    others += more;
  }
  const std::uint64_t cells = budget - std::min(budget, others);
  out.cells_bytes = fillable_bytes(cells);
  // In the recall, the memory of the window and of the distribution pass is free.
  out.recall_bytes = std::max(kMega, fillable_bytes(cells + (out.on_demand ? 0 : out.stream_buffer_bytes)));
  out.in_order_bytes = demand.in_order_bytes + (budget - std::min(budget, out.expected_bytes));
  add_slabs_to_turns(out, plan, demand, lists);
  return out;
}

/// Returns the least sufficient budget in bytes, a multiple of 1 MB. The expected memory of a plan grows more slowly
/// than its budget, so that bisection finds it.
std::uint64_t least_budget(const SweepPlan& plan, const MemoryDemand& demand) {
  const auto does = [&](std::uint64_t mega) {
    return Division(mega * kMega, plan, demand, false).find().expected_bytes <= mega * kMega;
  };
  std::uint64_t too_little = 0, enough = 32;
  while (!does(enough)) too_little = enough, enough *= 2;
  while (enough - too_little > 1) {
    const std::uint64_t middle = too_little + (enough - too_little) / 2;
    (does(middle) ? enough : too_little) = middle;
  }
  return enough * kMega;
}

}  // namespace

void fail_budget(std::uint64_t budget, std::uint64_t needed_bytes) {
  const std::string given = budget < kMega ? fmt::format("{} bytes", budget) : fmt::format("{} MB", budget >> 20);
  fail("A memory budget of {} is too small for this cloud and chain: give --memory {}M or more.", given,
       (needed_bytes + kMega - 1) >> 20);
}

std::uint64_t whole_window_bytes(const SweepPlan& plan, std::uint64_t points) {
  return points * (window_point_bytes(plan) + kept_list_bytes(plan));
}

std::uint64_t window_neighbors(const SweepPlan& plan, std::uint32_t cell_points, double dimension) {
  const double steps = static_cast<double>(plan.step_count()), k = static_cast<double>(plan.neighborhood.k);
  const double cell = static_cast<double>(usual_cell_points(cell_points));
  return static_cast<std::uint64_t>(
      std::pow(0.85 * std::pow(cell, 1 / dimension) + 2.5 * steps * std::pow(k, 1 / dimension), dimension));
}

MemoryPlan plan_memory(std::uint64_t budget, const SweepPlan& plan, const MemoryDemand& demand) {
  MemoryPlan out = divide(budget, plan, demand);
  if (out.expected_bytes > budget) out.needed_bytes = least_budget(plan, demand);
  return out;
}

}  // namespace pointsweep
