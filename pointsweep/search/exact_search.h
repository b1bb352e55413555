// SPDX-License-Identifier: MIT
/// The plain exact search of one point, all in double precision: for points around which too many others lie, for those
/// that single precision cannot decide, and for recalls.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/search/best_list.h"
#include "pointsweep/search/directory.h"

namespace pointsweep {

/// Offers to `best` every point of the cells in `near` (sorted as CellDirectory::find leaves them, by distance from a
/// box that contains `p`) that may belong, except the one of row `self_row`.
void search_exact(const CellDirectory& directory, const std::vector<CellDirectory::Near>& near, Vec3 p,
                  std::uint64_t self_row, BestList& best);

}  // namespace pointsweep
