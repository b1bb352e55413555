// SPDX-License-Identifier: MIT
/// Estimates how far neighbourhoods reach, from the density of the points, before any search.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/search/best_list.h"
#include "pointsweep/search/cell.h"

namespace pointsweep {

/// Returns the expected reach of the neighbourhoods of the points of each leaf, by leaf, in units of the cloud. No
/// result depends on it.
std::vector<double> expected_reaches(const Cell& cell, const Neighborhood& what);

}  // namespace pointsweep
