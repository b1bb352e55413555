// SPDX-License-Identifier: MIT
/// Many copies of one point: searched one by one, each would look at all others.
#pragma once

#include <cstdint>

#include "pointsweep/search/cell_search.h"

namespace pointsweep {

/// Returns the end of the leaves of a cell, from this one on, that all lie at one place; the leaf itself if it does
/// not.
std::uint32_t end_of_copies(const Cell& cell, std::uint32_t leaf);

/// Appends the neighbourhoods of points [first, end), all at one place, to `out`. One search is enough: the points have
/// the same k + 1 nearest, and each leaves out itself. scratch.near as in search_point_plainly().
void search_copies(const CellQuery& query, std::uint32_t first, std::uint32_t end, SearchScratch& scratch,
                   CellNeighbors& out);

}  // namespace pointsweep
