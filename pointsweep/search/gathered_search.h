// SPDX-License-Identifier: MIT
/// The search for many neighbours: the points around a leaf are gathered once, then every point of the leaf scans them,
/// a candidate per vector lane, all in double precision.
#pragma once

#include <cstdint>

#include "pointsweep/search/cell_search.h"

namespace pointsweep {

/// As search_cell(), for any k > 0 and any radius; appends to `out`. Where so many points lie around a leaf that
/// gathering them would not pay (copies of one point), its points are searched plainly.
/// 15 to 30 ns per neighbour on one core with AVX-512, about half of it for putting them in order.
void search_cell_gathered(const CellDirectory& directory, std::uint32_t slot, const Neighborhood& what,
                          SearchScratch& scratch, CellNeighbors& out);

}  // namespace pointsweep
