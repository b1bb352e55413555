// SPDX-License-Identifier: MIT
/// The window: the cells now in memory (the paper's active working set A).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "pointsweep/search/best_list.h"
#include "pointsweep/search/cell.h"
#include "pointsweep/sweep/frontier.h"
#include "pointsweep/sweep/plan.h"
#include "pointsweep/sweep/window_cell.h"

namespace pointsweep {

/// The cells that the sweep has read and still needs. Each cell leaves separately: a dense cell leaves early while a
/// sparse one beside it stays, so that neither an outlier nor a scanner's far field keeps dense parts in memory. Only
/// the thread of the sweep changes the window.
class Window : public CellSet {
 public:
  Window(const SweepPlan& plan, Frontier& frontier) : plan_(plan), frontier_(frontier) {}

  void admit(std::unique_ptr<WindowCell> cell);
  /// Returns the slots of the cells that can take step `step` now, ascending.
  std::vector<std::uint32_t> ready_for(std::uint32_t step) const;
  /// Adapts the waiting time of later cells to `slots`, the cells just searched for the first step. If many of these
  /// cells must be searched again, as in noise, later cells wait longer before their first search.
  void note_searched(const std::vector<std::uint32_t>& slots);
  /// Drops every finished cell that no unfinished cell refers to and that later points are unlikely to need.
  void drop();

  double lifespan_sum() const { return lifespan_sum_; }  ///< sum of seconds × points over cells that have left
  double lifespan_max() const { return lifespan_max_; }

 private:
  bool ready(const WindowCell& cell, std::uint32_t step) const;
  void note_saturated_location(const WindowCell& cell);
  double kept_clear(double reach) const;
  bool asks_for(const WindowCell& waiting, const WindowCell& cell) const;
  bool still_needed(const WindowCell& cell, const std::vector<const WindowCell*>& unsearched) const;

  const SweepPlan& plan_;
  Frontier& frontier_;
  double allowance_ = 1;  ///< factor on the expected reaches of cells that wait; grows while many of them wait
  double lifespan_sum_ = 0, lifespan_max_ = 0;
};

}  // namespace pointsweep
