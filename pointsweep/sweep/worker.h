// SPDX-License-Identifier: MIT
/// Memory and counters of one thread, and the functions that apply a step to points whose neighbour lists are known.
/// The sweep and the recall share these functions, so that a value never depends on which of the two has computed it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pointsweep/row_error.h"
#include "pointsweep/search/cell.h"
#include "pointsweep/search/cell_search.h"
#include "pointsweep/sweep/plan.h"
#include "pointsweep/sweep/stage_runner.h"
#include "pointsweep/sweep/window.h"

namespace pointsweep {

/// Copies of some points of a cell, for a rule or a step that is applied to these points only.
class ChosenPoints {
 public:
  /// Copies points of the cell, with the columns of the plan whose pointer in `columns` is not null.
  void take(const SweepPlan& plan, const Cell& cell, const CellSubset& points, const std::byte* const* columns);
  /// Allocates every column that the step makes and that was not copied, filled with 0.
  void make_columns(const SweepPlan& plan, std::size_t step);
  /// Copies the values that the step has made to the columns in `columns` that are not null.
  void give_back(const SweepPlan& plan, std::size_t step, std::byte* const* columns) const;

  std::size_t size() const { return chosen_.size(); }
  PointColumns view() const { return {x_.data(), y_.data(), z_.data(), row_.data(), pointers_.data()}; }
  std::byte* const* columns() const { return pointers_.data(); }
  const std::uint64_t* rows() const { return row_.data(); }

 private:
  std::vector<std::uint32_t> chosen_;
  std::vector<double> x_, y_, z_;
  std::vector<std::uint64_t> row_;
  std::vector<std::vector<std::byte>> columns_;
  std::vector<std::byte*> pointers_;
};

struct Worker {
  SearchScratch search;
  CellNeighbors neighbors;
  /// For each point of the cell, upper bound of the squared radius of its neighbourhood.
  std::vector<double> reach2;
  std::vector<std::uint32_t> named;  ///< window slots of the cells that hold neighbours of the current cell
  std::vector<bool> is_named;        ///< for each slot, true if `named` holds it
  std::vector<Box> dropped;
  std::vector<std::byte*> columns;  ///< columns of the current cell, by column number
  std::vector<const std::byte*> own_columns;
  std::vector<std::byte*> run_columns;  ///< `columns`, each from the first of some successive points of the cell on
  std::vector<std::byte> passing;       ///< memory of the columns that are needed only in the current step
  ChosenPoints chosen;  ///< copies of the points that take the step, unless these are a run (CellSubset::is_run())
  CellNeighbors chosen_lists;
  std::vector<std::byte> results;
  StageTally tally;
  /// Tally of evaluations that do not count: of points whose values only other points need, or of steps taken before.
  StageTally halo;
  FirstRowError unwritten;  ///< error of the lowest row whose results the sink cannot take
  double search_seconds = 0;
  /// Deferred points of the cells that this thread has finished, and the number of certified points of these cells. The
  /// recall adds the points that it finishes.
  std::vector<DeferredPoint> deferred;
  std::uint64_t certified = 0;
};

/// Sets worker.columns to the columns of the cell and of the step. Of the columns that the step makes, those of
/// Lifetime::cell are added to the cell, and the others belong to the worker. Their values are 0 until an operator
/// writes them.
void place_columns(const SweepPlan& plan, std::uint32_t step, WindowCell& cell, Worker& worker);
/// Sets worker.columns as place_columns() does, but leaves the columns that are needed only in the step null.
void place_cell_columns(const SweepPlan& plan, std::uint32_t step, WindowCell& cell, Worker& worker);

/// Drops all lists except the lists with the numbers `kept`, ascending.
void keep_lists_of(std::span<const std::uint32_t> kept, CellNeighbors& lists);

/// Applies the step to `points` of the cell; `lists` holds one list for each. Operators get a bounded number of
/// neighbours at a time (more only for a single point that has more), so that a run can be cancelled soon: after each
/// part of the points, `done` is called with the part, and tally.marked holds the degenerate points of the part. If
/// `points` is not a run (CellSubset::is_run()), each part is copied to worker.chosen, which then holds the part with
/// all columns.
void apply_step(const SweepPlan& plan, std::uint32_t step, const Cell& cell, const CellSubset& points,
                const CellNeighbors& lists, const PointColumns* slots, Worker& worker, StageTally& tally,
                const std::function<void(const CellSubset& part)>& done);

}  // namespace pointsweep
