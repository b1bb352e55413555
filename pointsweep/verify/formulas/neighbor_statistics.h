// SPDX-License-Identifier: MIT
/// Formulas of the statistics of the neighbours' values.
#pragma once

#include <string_view>
#include <vector>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// The statistic of this name of scalar values, of which those that are not finite do not count: mean, median, min,
/// max, range, deviation (of the population), majority (of several most frequent values the one that comes first) or
/// count. mean, median, range and deviation are evaluated in float64 from differences to the first value. Without a
/// value that counts: NaN.
Estimate statistic_of(std::string_view name, const std::vector<Estimate>& values);

}  // namespace pointsweep::formulas
