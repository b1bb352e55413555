// SPDX-License-Identifier: MIT
/// The value that points of another cloud give to a point.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "pointsweep/verify/formulas/assignment.h"
#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// Returns what the values of the nearest points give, nearest first: their majority (of several the one that comes
/// first), their mean or the first. Where there are several, and for means, only finite values count. Nothing if no
/// value counts. `are_whole`: the mean is that of their exact sum.
std::optional<Estimate> voted(std::string_view vote, const std::vector<Real>& values, bool are_whole);

/// Returns the value as an attribute holds it: of whole numbers the nearest, halves to even; float32; or float64.
Estimate stored(const Estimate& value, Storage storage);

}  // namespace pointsweep::formulas
