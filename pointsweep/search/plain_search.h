// SPDX-License-Identifier: MIT
/// The neighbourhood operator point by point in double precision, whatever is asked for: for points that the vector
/// code gives back, and machines without vectors.
#pragma once

#include "pointsweep/search/cell_search.h"

namespace pointsweep {

/// Leaves the neighbourhood of point `i` of `cell` in scratch.best, to be finished. `reach2`: the squared distance from
/// the cell's box within which scratch.near holds every cell, nearest first; both grow as needed.
void search_point_plainly(const CellDirectory& directory, const Cell& cell, std::uint32_t i, const Neighborhood& what,
                          SearchScratch& scratch, double& reach2);

/// The same of a place in the cell, where the point of row `self_row` does not count.
void search_place_plainly(const CellDirectory& directory, const Cell& cell, Vec3 place, std::uint64_t self_row,
                          const Neighborhood& what, SearchScratch& scratch, double& reach2);

/// Appends the neighbourhood in scratch.best to `out`, and the squared distance at which it ends.
void append_best(const Neighborhood& what, SearchScratch& scratch, CellNeighbors& out);

/// As search_points(), for any k; appends to `out`.
std::uint32_t search_points_plainly(const CellDirectory& directory, std::uint32_t slot, std::uint32_t first,
                                    std::uint64_t most, const Neighborhood& what, SearchScratch& scratch,
                                    CellNeighbors& out);
/// As search_chosen(), for any k; appends to `out`.
std::size_t search_chosen_plainly(const CellDirectory& directory, std::uint32_t slot,
                                  std::span<const std::uint32_t> points, std::uint64_t most, const Neighborhood& what,
                                  SearchScratch& scratch, CellNeighbors& out);
/// As search_cell(), for any k; appends to `out`.
void search_cell_plainly(const CellDirectory& directory, std::uint32_t slot, const Neighborhood& what,
                         SearchScratch& scratch, CellNeighbors& out);

}  // namespace pointsweep
