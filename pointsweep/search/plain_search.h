// SPDX-License-Identifier: MIT
/// The neighbourhood operator point by point in double precision, for any k and radius. Used for points that the vector
/// code cannot decide, and on machines without vectors.
#pragma once

#include "pointsweep/search/cell_search.h"

namespace pointsweep {

/// Leaves the neighbourhood of the point of index `i` in scratch.best, to be finished. scratch.near holds cells near
/// the cell of the query, and grows as needed.
void search_point_plainly(const CellQuery& query, std::uint32_t i, SearchScratch& scratch);

/// Leaves the neighbourhood of a place in the cell in scratch.best, without the point of row `self_row`.
void search_place_plainly(const CellQuery& query, Vec3 place, std::uint64_t self_row, SearchScratch& scratch);

/// Appends the neighbourhood in scratch.best to `out`, and the squared distance at which it ends.
void append_best(const Neighborhood& what, SearchScratch& scratch, CellNeighbors& out);

/// The function search() for any k; appends to `out`.
std::uint32_t search_plainly(const CellQuery& query, const CellSubset& points, std::uint64_t most,
                             SearchScratch& scratch, CellNeighbors& out);

}  // namespace pointsweep
