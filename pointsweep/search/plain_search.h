// SPDX-License-Identifier: MIT
/// The neighbourhood operator of a cell, point by point in double precision: for k too large for registers, radius
/// neighbourhoods of any size, and machines without vectors.
#pragma once

#include "pointsweep/search/cell_search.h"

namespace pointsweep {

/// As search_cell(), for any k; appends to `out`.
void search_cell_plainly(const CellDirectory& directory, std::uint32_t slot, const Neighborhood& what,
                         SearchScratch& scratch, CellNeighbors& out);

}  // namespace pointsweep
