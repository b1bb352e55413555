// SPDX-License-Identifier: MIT
/// How far neighbourhoods should reach, guessed from the density of the points before any search.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/search/best_list.h"
#include "pointsweep/search/cell.h"

namespace pointsweep {

/// In length units, for the points of each leaf. No result depends on it.
std::vector<double> expected_reaches(const Cell& cell, const Neighborhood& what);

}  // namespace pointsweep
