// SPDX-License-Identifier: MIT
/// Takes one cell through one step: search, certificate (the proof that neighbourhoods are complete), stages, delivery
/// of results. This is the pull-push of the paper (Figures 12 and 14), for all points of a cell at once.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/sweep/cell_lists.h"
#include "pointsweep/sweep/frontier.h"
#include "pointsweep/sweep/window.h"

namespace pointsweep {

class CellRunner {
 public:
  CellRunner(const SweepPlan& plan, Window& window, const Frontier& frontier, Sink& sink, const ListMemory& memory);

  /// Takes the cell in `slot` through `step`. Thread-safe for different cells that are ready for the step, if each
  /// thread has its own worker.
  void run(std::uint32_t slot, std::uint32_t step, Worker& worker) const;

 private:
  void run_first_step(std::uint32_t slot, bool all_found, Worker& worker) const;
  void run_later_step(std::uint32_t slot, std::uint32_t step, Worker& worker) const;
  void apply(std::uint32_t step, WindowCell& cell, const CellSubset& run, const CellNeighbors& lists,
             Worker& worker) const;
  void look_no_further(WindowCell& cell, std::uint32_t step) const;
  void finish(WindowCell& cell, Worker& worker) const;
  void hand_over(const WindowCell& cell, Worker& worker) const;
  void drop_columns(WindowCell& cell) const;

  const SweepPlan& plan_;
  Window& window_;
  const Frontier& frontier_;
  Sink& sink_;
  std::vector<bool> read_of_neighbors_;  ///< for each column, true if a stage reads values of neighbours
  CellLists lists_;
};

}  // namespace pointsweep
