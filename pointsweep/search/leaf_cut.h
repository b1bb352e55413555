// SPDX-License-Identifier: MIT
/// Cutting one cell into leaves of 16, in vector code.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "pointsweep/search/cut.h"

namespace pointsweep {

/// Reorders at most kCellCapacity points so that consecutive runs of 16 are compact: halves across the longest side,
/// at a multiple of 16, again and again. Points at one and the same place are ordered by `row_of(index)`. The same
/// order on every instruction set. About 30 ns per point.
void cut_into_leaves(std::span<CutPoint> points, const std::function<std::uint64_t(std::uint32_t index)>& row_of);

}  // namespace pointsweep
