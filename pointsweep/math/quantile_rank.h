// SPDX-License-Identifier: MIT
/// The definition of a quantile, shared by statistics, reports and pictures.
#pragma once

#include <cstdint>

#include "pointsweep/math/exact_sum.h"

namespace pointsweep {

/// Returns the rank, from 0 in ascending order, of the quantile `part / whole` of `count` >= 1 values: floor((count -
/// 1) · part / whole), computed in integers. So a quantile is one of the values: the least for part = 0 and the
/// greatest for part = whole.
inline std::uint64_t quantile_rank(std::uint64_t count, std::uint32_t part, std::uint32_t whole = 100) {
  return static_cast<std::uint64_t>(UInt128{count - 1} * part / whole);
}

}  // namespace pointsweep
