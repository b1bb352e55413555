// SPDX-License-Identifier: MIT
/// Formulas of the statistics of the neighbours' values, and of the value that points of another cloud give to a point.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "pointsweep/verify/formulas/estimate.h"
#include "pointsweep/verify/formulas/plain_expression.h"

namespace pointsweep::formulas {

/// Returns a statistic of the finite values: mean, median, min, max, range, deviation (of the population), majority
/// (the first in the list if several are equally frequent) or count. mean, median, range and deviation are evaluated in
/// float64, mean and deviation from differences to the first value. Without a finite value, count is 0 and all others
/// are NaN. Open if a value is in doubt or may have either sign.
Estimate statistic_of(std::string_view name, const std::vector<Estimate>& values);

/// Returns the value that a point takes from `values`, the values of the nearest points, nearest first. `vote`:
/// "nearest" takes the first value, "majority" the most frequent value (the first of equally frequent ones), "mean" the
/// mean. Only finite values count, except for "nearest" and for the majority of a single value. Returns nothing if no
/// value counts. `are_whole`: true to compute the mean from the exact sum.
std::optional<Estimate> voted(std::string_view vote, const std::vector<Real>& values, bool are_whole);

/// Returns the value as an attribute stores it: the nearest whole number, halves to even; float32; or float64.
Estimate stored(const Estimate& value, Storage storage);

}  // namespace pointsweep::formulas
