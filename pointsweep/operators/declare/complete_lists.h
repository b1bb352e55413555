// SPDX-License-Identifier: MIT
/// A check for operators that count neighbours within a distance: the neighbourhoods must contain all of them.
#pragma once

#include <cstddef>
#include <string>

namespace pointsweep {

struct Facts;

/// Throws UsageError, beginning with `where`, unless the neighbourhoods in effect contain the `k` nearest points within
/// `radius`, or all points within `radius` if k is Neighborhood::kUnlimited. Accepts neighbourhoods that are unknown,
/// and neighbourhoods whose k is the default of the operators.
void require_complete_lists(const Facts& facts, std::size_t k, double radius, const std::string& where);

}  // namespace pointsweep
