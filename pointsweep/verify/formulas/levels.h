// SPDX-License-Identifier: MIT
/// Levels of detail from their definition: octants by division, leaves by counting, one loop over all points for each
/// depth.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/verify/formulas/thinning.h"

namespace pointsweep::formulas {

/// Bytes of memory for each point while levels are found.
inline constexpr std::uint64_t kLevelBytes = 160;

/// Returns the level of each point. All coordinates must be finite. Points with equal rounded coordinates are taken in
/// the order of `points`.
std::vector<std::uint8_t> levels_of(const std::vector<Coordinates>& points);

}  // namespace pointsweep::formulas
