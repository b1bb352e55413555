// SPDX-License-Identifier: MIT
/// Statistics of points as tables, for people.
#pragma once

#include <string>

#include "pointsweep/info.h"

namespace pointsweep {

/// Returns tables with the number of points of each group and a line for each attribute of each group, and histograms
/// with bars.
std::string to_text(const PointStatistics& statistics);

}  // namespace pointsweep
