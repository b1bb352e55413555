// SPDX-License-Identifier: MIT
/// Operators that count neighbours within a distance need lists that hold them.
#pragma once

#include <cstddef>
#include <string>

namespace pointsweep {

struct Facts;

/// Throws UsageError, beginning with `where`, unless the neighbourhoods in effect hold the `k` nearest within `radius`:
/// all of them where k is Neighborhood::kUnlimited. Nothing is refused where the facts do not tell the neighbourhoods,
/// or where these are those of the operators.
void require_complete_lists(const Facts& facts, std::size_t k, double radius, const std::string& where);

}  // namespace pointsweep
