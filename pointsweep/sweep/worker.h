// SPDX-License-Identifier: MIT
/// Memory and counters of one thread of a sweep or of a recall.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/row_error.h"
#include "pointsweep/search/cell_search.h"
#include "pointsweep/sweep/chosen_points.h"
#include "pointsweep/sweep/deferred_point.h"
#include "pointsweep/sweep/stage_runner.h"

namespace pointsweep {

struct Worker {
  SearchScratch search;
  CellNeighbors neighbors;
  std::vector<double> reach2;        ///< by point of the cell: squared radius of its neighbourhood
  std::vector<std::uint32_t> named;  ///< slots that the lists of a cell name
  std::vector<bool> is_named;        ///< by slot
  std::vector<Box> dropped;
  std::vector<std::byte*> columns;  ///< columns of the current cell, by column number
  std::vector<const std::byte*> own_columns;
  std::vector<std::byte*> run_columns;  ///< `columns`, from the first point of a run on
  std::vector<std::byte> passing;       ///< memory of the columns that do not outlast the step
  ChosenPoints chosen;                  ///< the points that take the step, if not all points of the cell do
  CellNeighbors chosen_lists;
  std::vector<std::byte> results;
  StageTally tally;
  StageTally halo;          ///< tally of points that a recall evaluates only because others need their values
  FirstRowError unwritten;  ///< error of a row whose results the sink cannot take; ends the sweep
  double search_seconds = 0;
  /// Points and counts of finished cells.
  std::vector<DeferredPoint> deferred;
  std::vector<UnresolvedPoint> unresolved;
  std::uint64_t certified = 0;
};

}  // namespace pointsweep
