// SPDX-License-Identifier: MIT
/// The random sample of the rows that a check evaluates, and their places in an output in the order of the sweep.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/verify/rows/row_source.h"

namespace pointsweep {

/// `size` different rows of 0 ... count - 1, ascending, every set of them equally likely; all rows if there are no
/// more. The same seed gives the same rows.
std::vector<std::uint64_t> sample_rows(std::uint64_t count, std::uint64_t size, std::uint64_t seed);

/// For each of `rows` of the input, which ascend, its row in canonical order along `axis`: by the coordinate on it,
/// ties by x, y, z, then row; points that are not finite last, by row. Reads the input once more and counts: O(n log
/// rows).
std::vector<std::uint64_t> sweep_rows(RowSource& in, std::span<const std::uint64_t> rows, int axis,
                                      const PhaseProgress& progress);

}  // namespace pointsweep
