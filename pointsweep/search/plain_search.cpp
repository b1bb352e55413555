// SPDX-License-Identifier: MIT
#include "pointsweep/search/plain_search.h"

#include <algorithm>
#include <limits>

#include "pointsweep/cancellation.h"
#include "pointsweep/search/exact_search.h"

namespace pointsweep {

void search_place_plainly(const CellDirectory& directory, const Cell& cell, Vec3 place, std::uint64_t self_row,
                          const Neighborhood& what, SearchScratch& scratch, double& reach2) {
  for (;;) {
    scratch.best.start(what);
    search_exact(directory, scratch.near, place, self_row, scratch.best);
    if (scratch.best.limit() <= reach2) return;
    reach2 = std::max(2 * scratch.best.limit(), std::numeric_limits<double>::min());
    directory.find(cell.box, reach2, scratch.near);
  }
}

void search_point_plainly(const CellDirectory& directory, const Cell& cell, std::uint32_t i, const Neighborhood& what,
                          SearchScratch& scratch, double& reach2) {
  search_place_plainly(directory, cell, cell.position(i), cell.row[i], what, scratch, reach2);
}

void append_best(const Neighborhood& what, SearchScratch& scratch, CellNeighbors& out) {
  const std::vector<Candidate>& found = scratch.best.finish();
  for (const Candidate& c : found) out.refs.push_back(c.ref);
  out.reach2.push_back(found.size() == what.k ? found.back().distance2 : what.radius2());
  out.begin.push_back(static_cast<std::uint32_t>(out.refs.size()));
}

std::uint32_t search_points_plainly(const CellDirectory& directory, std::uint32_t slot, std::uint32_t first,
                                    std::uint64_t most, const Neighborhood& what, SearchScratch& scratch,
                                    CellNeighbors& out) {
  const Cell& cell = directory.cell(slot);
  double reach2 = 0;
  directory.find(cell.box, reach2, scratch.near);
  std::uint32_t i = first;
  for (; i < cell.size() && (i == first || out.refs.size() < most); ++i) {
    stop_if_cancelled();
    search_point_plainly(directory, cell, i, what, scratch, reach2);
    append_best(what, scratch, out);
  }
  return i;
}

std::size_t search_chosen_plainly(const CellDirectory& directory, std::uint32_t slot,
                                  std::span<const std::uint32_t> points, std::uint64_t most, const Neighborhood& what,
                                  SearchScratch& scratch, CellNeighbors& out) {
  const Cell& cell = directory.cell(slot);
  double reach2 = 0;
  directory.find(cell.box, reach2, scratch.near);
  std::size_t n = 0;
  for (; n < points.size() && (n == 0 || out.refs.size() < most); ++n) {
    stop_if_cancelled();
    search_point_plainly(directory, cell, points[n], what, scratch, reach2);
    append_best(what, scratch, out);
  }
  return n;
}

void search_cell_plainly(const CellDirectory& directory, std::uint32_t slot, const Neighborhood& what,
                         SearchScratch& scratch, CellNeighbors& out) {
  search_points_plainly(directory, slot, 0, std::numeric_limits<std::uint64_t>::max(), what, scratch, out);
}

}  // namespace pointsweep
