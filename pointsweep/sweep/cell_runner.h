// SPDX-License-Identifier: MIT
/// Takes one cell through one step: search, certificate, stages, and out (the pull-push of a point, Figures 12 and 14,
/// done for a thousand points at once).
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "pointsweep/sweep/stage_runner.h"
#include "pointsweep/sweep/window.h"

namespace pointsweep {

/// Memory and counters of one thread.
struct Worker {
  SearchScratch search;
  CellNeighbors neighbors;
  std::vector<std::uint32_t> named;  ///< slots that the lists of a cell name
  std::vector<bool> is_named;        ///< by slot
  std::vector<Box> dropped;
  std::vector<std::byte*> columns;  ///< of the cell in hand, by column number
  std::vector<std::byte> passing;   ///< those of them that do not outlast the step
  std::vector<std::byte> results;
  StageTally tally;
  double search_seconds = 0;
  /// Of finished cells.
  std::vector<DeferredPoint> deferred;
  std::uint64_t certified = 0, degenerate = 0;
};

class CellRunner {
 public:
  /// `cells_bytes`: what the cells of the window may take, lists included. Lists that later steps need and that do not
  /// fit are found again then, the same ones.
  CellRunner(const SweepPlan& plan, Window& window, const Outside& outside, Sink& sink, std::uint64_t cells_bytes);

  /// Thread-safe for different cells that are ready for the step, each thread with a worker of its own.
  void run(std::uint32_t slot, std::uint32_t step, Worker& worker) const;

 private:
  bool search(std::uint32_t slot, Worker& worker) const;
  const CellNeighbors& lists_of(std::uint32_t slot, Worker& worker) const;
  void refer(WindowCell& cell, const CellNeighbors& lists, Worker& worker) const;
  bool keep_lists(WindowCell& cell, const CellNeighbors& found) const;
  void release_lists(WindowCell& cell) const;
  bool certify(WindowCell& cell, const CellNeighbors& found, Worker& worker) const;
  void wait(WindowCell& cell, const CellNeighbors& found) const;
  void defer_points_of_deferred_neighbors(WindowCell& cell, const CellNeighbors& lists) const;
  static void defer(WindowCell& cell, std::uint32_t i, double reach2);
  void place_columns(WindowCell& cell, std::uint32_t step, Worker& worker) const;
  void apply(WindowCell& cell, std::uint32_t step, const CellNeighbors& lists, Worker& worker) const;
  void apply_to_some(WindowCell& cell, std::uint32_t step, const CellNeighbors& lists, Worker& worker) const;
  void finish(WindowCell& cell, Worker& worker) const;
  void hand_over(const WindowCell& cell, Worker& worker) const;
  void drop_columns(WindowCell& cell) const;

  const SweepPlan& plan_;
  Window& window_;
  const Outside& outside_;
  Sink& sink_;
  std::vector<bool> read_of_neighbors_;  ///< by column: whether a stage looks at it in other cells
  std::uint64_t cells_bytes_;
  std::uint64_t point_bytes_ = 48;                     ///< coordinates, row, place and share of boxes; and columns
  mutable std::atomic<std::uint64_t> list_bytes_ = 0;  ///< of all lists kept now
};

}  // namespace pointsweep
