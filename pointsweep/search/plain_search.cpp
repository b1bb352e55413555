// SPDX-License-Identifier: MIT
#include "pointsweep/search/plain_search.h"

#include <algorithm>
#include <limits>

#include "pointsweep/cancellation.h"
#include "pointsweep/search/exact_search.h"

namespace pointsweep {

void search_place_plainly(const CellQuery& query, Vec3 place, std::uint64_t self_row, SearchScratch& scratch) {
  for (;;) {
    scratch.best.start(query.what);
    search_exact(query.directory, scratch.near.cells, place, self_row, scratch.best);
    if (scratch.best.limit() <= scratch.near.reach2) return;
    scratch.near.find(query, std::max(2 * scratch.best.limit(), std::numeric_limits<double>::min()));
  }
}

void search_point_plainly(const CellQuery& query, std::uint32_t i, SearchScratch& scratch) {
  search_place_plainly(query, query.cell().position(i), query.cell().row[i], scratch);
}

void append_best(const Neighborhood& what, SearchScratch& scratch, CellNeighbors& out) {
  const std::vector<Candidate>& found = scratch.best.finish();
  for (const Candidate& c : found) out.refs.push_back(c.ref);
  out.reach2.push_back(found.size() == what.k ? found.back().distance2 : what.radius2());
  out.begin.push_back(static_cast<std::uint32_t>(out.refs.size()));
}

std::uint32_t search_plainly(const CellQuery& query, const CellSubset& points, std::uint64_t most,
                             SearchScratch& scratch, CellNeighbors& out) {
  scratch.near.find(query, 0);
  std::uint32_t n = 0;
  for (; n < points.size() && (n == 0 || out.refs.size() < most); ++n) {
    stop_if_cancelled();
    search_point_plainly(query, points[n], scratch);
    append_best(query.what, scratch, out);
  }
  return n;
}

}  // namespace pointsweep
