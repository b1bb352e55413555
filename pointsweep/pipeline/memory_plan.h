// SPDX-License-Identifier: MIT
/// The memory plan: which data are kept in memory and which are spilled, so that a run stays within its budget. The
/// window holds the points that a sweep has in memory (sweep/window.h); the recall finishes points whose neighbours
/// have left the window (sweep/recall.h).
#pragma once

#include <cstdint>
#include <optional>

#include "pointsweep/sweep/plan.h"

namespace pointsweep {

struct MemoryDemand {
  std::uint64_t points = 0;
  std::uint64_t working_record_bytes = 0;
  std::uint64_t result_record_bytes = 0;
  std::uint64_t slab_points = 0;
  std::uint32_t slabs_per_turn = 0;  ///< slabs that the sweep reads together; 0: the plan chooses
  unsigned threads = 1;
  std::uint32_t cell_points = 1024;
  std::uint64_t in_order_bytes = 0;     ///< least memory of an in-order operator
  std::uint64_t connect_bytes = 0;      ///< estimated memory of a spanning forest, which grows after the sweep
  std::uint64_t listed_edge_bytes = 0;  ///< bytes of the edge that a thread makes for each neighbour in its lists
  std::uint64_t codec_bytes = 0;        ///< memory for decoding the inputs and encoding the output
  std::uint64_t most_neighbors = 0;     ///< estimate for a radius without a limit k: the most neighbours of a point
  /// Estimate for a radius without a limit k: the points that the radius keeps in the window, which lie in a slice
  /// across the axis as thick as the radius times (steps + 1).
  std::uint64_t slice_points = 0;
  /// Estimate for several steps with a limit k: points that stay in the window, in addition to the slabs near the sweep
  /// plane, because their cells wait for one another (window_neighbors()); 0 if a window of all points fits into half
  /// of the budget.
  std::uint64_t waiting_for_steps = 0;
  /// Estimated number of points that wait in memory if slabs are made on demand; absent if that is impossible.
  std::optional<std::uint64_t> waiting_points = {};
};

struct MemoryPlan {
  bool spill_stream = false;
  bool spill_results = false;
  bool on_demand = false;  ///< slabs are made when they are read; ordering spills nothing
  std::uint64_t slab_points = 0;
  std::uint64_t stream_buffer_bytes = 0;  ///< buffers of the distribution pass, or for slabs on demand
  std::uint64_t result_buffer_bytes = 0;
  std::uint64_t most_waiting = 0;    ///< most points that may wait in memory for slabs that are made on demand
  std::uint64_t recall_bytes = 0;    ///< limit for the points that the recall has in memory
  std::uint32_t slabs_per_turn = 1;  ///< slabs that the sweep reads before it runs the steps
  std::uint64_t window_bytes = 0;    ///< expected memory of the window, including memory that threads use at a time
  std::uint64_t threads_bytes = 0;   ///< memory of all threads with the thinnest slabs; 0 if nothing is recalled
  std::uint64_t cells_bytes = 0;     ///< limit for the cells of the window
  std::uint64_t in_order_bytes = 0;  ///< limit for an in-order operator
  std::uint64_t lists_bytes = 0;     ///< memory for the lists that each thread uses at a time
  std::uint64_t expected_bytes = 0;  ///< expected memory of the whole process in this pass
  std::uint64_t needed_bytes = 0;    ///< least sufficient budget; 0 if the given one suffices
};

/// Memory of a run that does not grow with the cloud: code and the chunks that are being read and written.
inline constexpr std::uint64_t kFixedBytes = 24u << 20;

/// Returns the bytes of a window that holds all points, with the neighbour lists that are kept for later steps.
std::uint64_t whole_window_bytes(const SweepPlan& plan, std::uint64_t points);

/// Returns the number of points in a ball that is as wide as the stretch along the axis in which several steps keep
/// points; Estimates::open_points() takes it as k. The width of the stretch is 0.85 times the width of a ball with the
/// points of an ordinary cell, plus, for each step, 2.5 times the width of a neighbourhood's ball. With this number,
/// plans have room for 1.1 to 3.1 times the points that were in the window of four clouds of 1M points (k = 8 and 64,
/// two and three steps, slabs of 8,192 and 32,768 points), and for more than 3.1 times in the smallest windows. For a
/// wall across the axis the number is too large.
std::uint64_t window_neighbors(const SweepPlan& plan, std::uint32_t cell_points, double dimension);

/// Plans a pass. Prefers memory, then slabs on demand (if possible), then spilling, then thinner slabs. A budget larger
/// than a sufficient one also suffices. For a budget that is too small, MemoryPlan::needed_bytes states the least
/// sufficient one.
MemoryPlan plan_memory(std::uint64_t budget, const SweepPlan& plan, const MemoryDemand& demand);
/// Throws the Error for a budget that is too small.
[[noreturn]] void fail_budget(std::uint64_t budget, std::uint64_t needed_bytes);

/// Returns the number of MB, of 2^20 bytes each, for a sentence.
inline double megabytes(std::uint64_t bytes) { return static_cast<double>(bytes) / (1 << 20); }

}  // namespace pointsweep
