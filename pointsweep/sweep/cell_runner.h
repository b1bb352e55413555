// SPDX-License-Identifier: MIT
/// Takes one cell through one step: search, certificate, stages, and out (the pull-push of a point, Figures 12 and 14,
/// done for a thousand points at once).
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "pointsweep/sweep/window.h"
#include "pointsweep/sweep/worker.h"

namespace pointsweep {

struct RunnerMemory {
  /// What the cells of the window may take, lists included. Lists that later steps need and that do not fit are found
  /// again then, the same ones.
  std::uint64_t cells_bytes;
  /// What the lists that a thread has in hand may take, unless those of one point take more. The lists of a cell that
  /// need more are found, used and dropped run by run.
  std::uint64_t lists_bytes;
};

class CellRunner {
 public:
  CellRunner(const SweepPlan& plan, Window& window, const Outside& outside, Sink& sink, const RunnerMemory& memory);

  /// Thread-safe for different cells that are ready for the step, each thread with a worker of its own.
  void run(std::uint32_t slot, std::uint32_t step, Worker& worker) const;

 private:
  bool find_reaches(std::uint32_t slot, Worker& worker) const;
  bool certify(WindowCell& cell, Worker& worker) const;
  void wait(WindowCell& cell, const std::vector<double>& reach2) const;
  std::uint32_t find_lists(std::uint32_t slot, std::uint32_t first, Worker& worker) const;
  PointColumns own_from(const WindowCell& cell, std::uint32_t first, Worker& worker) const;
  void run_first_step(std::uint32_t slot, bool all_found, Worker& worker) const;
  void run_later_step(std::uint32_t slot, std::uint32_t step, Worker& worker) const;
  void note_named(const WindowCell& cell, std::uint32_t first, const CellNeighbors& lists, Worker& worker) const;
  static void refer_to_named(WindowCell& cell, Worker& worker);
  bool keep_lists(WindowCell& cell, const CellNeighbors& found) const;
  void release_lists(WindowCell& cell) const;
  void defer_points_of_deferred_neighbors(WindowCell& cell, std::uint32_t first, const CellNeighbors& lists) const;
  static void defer(WindowCell& cell, std::uint32_t i, double reach2);
  void finish(WindowCell& cell, Worker& worker) const;
  void hand_over(const WindowCell& cell, Worker& worker) const;
  void drop_columns(WindowCell& cell) const;

  const SweepPlan& plan_;
  Window& window_;
  const Outside& outside_;
  Sink& sink_;
  std::vector<bool> read_of_neighbors_;  ///< by column: whether a stage looks at it in other cells
  RunnerMemory memory_;
  std::uint64_t point_bytes_ = kWindowPointBytes;      ///< and columns
  mutable std::atomic<std::uint64_t> list_bytes_ = 0;  ///< of all lists kept now
};

}  // namespace pointsweep
