// SPDX-License-Identifier: MIT
/// The neighbourhood operator point by point in double precision, for any k and radius. Used for points that the vector
/// code cannot decide, for many copies of one point, and on machines without vectors.
#pragma once

#include <cstdint>

#include "pointsweep/search/best_list.h"
#include "pointsweep/search/cell_search.h"
#include "pointsweep/search/directory.h"

namespace pointsweep {

/// Searches the neighbourhood of the point with index `i` and leaves it in scratch.best, on which the caller calls
/// finish(). scratch.near holds cells near the cell of the query, and grows as needed.
void search_point_plainly(const CellQuery& query, std::uint32_t i, SearchScratch& scratch);

/// Searches the neighbourhood of a place in the cell, without the point with row `self_row`, and leaves the
/// neighbourhood in scratch.best.
void search_place_plainly(const CellQuery& query, Vec3 place, std::uint64_t self_row, SearchScratch& scratch);

/// Appends the neighbourhood in scratch.best to `out`, and the squared distance at which it ends.
void append_best(const Neighborhood& what, SearchScratch& scratch, CellNeighbors& out);

/// The function search() for any k; appends to `out`.
std::uint32_t search_plainly(const CellQuery& query, const CellSubset& points, std::uint64_t most,
                             SearchScratch& scratch, CellNeighbors& out);

/// Returns a point of a cell as a candidate for the neighbourhood of p.
inline Candidate candidate_from(const CellDirectory& directory, NeighborRef ref, Vec3 p) {
  const Cell& cell = directory.cell(slot_of(ref));
  const Vec3 at = cell.position(index_of(ref));
  return {distance2(at, p), at, cell.row[index_of(ref)], ref};
}

/// Sorts runs of a list of at most 64 neighbours of p exactly, where single precision could not decide. Bit i of
/// `close_to_next` says that places i and i + 1 belong to one run.
void order_runs(const CellDirectory& directory, Vec3 p, std::uint64_t close_to_next, NeighborRef* refs);

/// Returns the end of the run of leaves, from `leaf` on, whose points all coincide; returns `leaf` if its points differ
/// or if it has only one.
std::uint32_t end_of_copies(const Cell& cell, std::uint32_t leaf);

/// Appends the neighbourhoods of points [first, end), which coincide, to `out`. One search is enough: coincident points
/// share their k + 1 nearest points, and each point leaves out itself. scratch.near is used as in
/// search_point_plainly().
void search_copies(const CellQuery& query, std::uint32_t first, std::uint32_t end, SearchScratch& scratch,
                   CellNeighbors& out);

}  // namespace pointsweep
