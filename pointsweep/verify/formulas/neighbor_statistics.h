// SPDX-License-Identifier: MIT
/// Formulas of the statistics of the neighbours' values.
#pragma once

#include <string_view>
#include <vector>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// Returns a statistic of the finite values: mean, median, min, max, range, deviation (of the population), majority
/// (the first in the list if several are equally frequent) or count. mean, median, range and deviation are evaluated in
/// float64 from differences to the first value. NaN without a finite value.
Estimate statistic_of(std::string_view name, const std::vector<Estimate>& values);

}  // namespace pointsweep::formulas
