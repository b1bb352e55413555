// SPDX-License-Identifier: MIT
/// The rows of chosen points in an output whose rows are in the order of the sweep.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/verify/rows/row_source.h"

namespace pointsweep {

/// For each of `rows` of the input, which ascend, its row in canonical order along `axis`: by the coordinate on it,
/// ties by x, y, z, then row; points that are not finite last, by row. Reads the input once more and counts: O(n log
/// rows).
std::vector<std::uint64_t> sweep_rows(RowSource& in, std::span<const std::uint64_t> rows, int axis,
                                      const PhaseProgress& progress);

}  // namespace pointsweep
