// SPDX-License-Identifier: MIT
/// Many copies of one point: searched one by one, each would look at all others.
#pragma once

#include <cstdint>

#include "pointsweep/search/cell_search.h"

namespace pointsweep {

/// Behind the leaves of a cell, from this one on, that all lie at one place; the leaf itself if it does not.
std::uint32_t end_of_copies(const Cell& cell, std::uint32_t leaf);

/// The neighbourhoods of points [first, end), all at one place, appended to `out`: one search, for they have the same
/// k + 1 nearest and each leaves out itself. `reach2` as in search_point_plainly().
void search_copies(const CellDirectory& directory, const Cell& cell, std::uint32_t first, std::uint32_t end,
                   const Neighborhood& what, SearchScratch& scratch, double& reach2, CellNeighbors& out);

}  // namespace pointsweep
