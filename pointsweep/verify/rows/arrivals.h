// SPDX-License-Identifier: MIT
/// Comparison of all points and attributes of two clouds, row by row and by checksums.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "pointsweep/verify.h"
#include "pointsweep/verify/rows/row_source.h"

namespace pointsweep {

/// Reads both files once, side by side. `replaced[f]`: field f of the input was computed again and is not compared.
/// `look` is called with every row and position of the input.
Arrivals compare_arrivals(RowSource& in, RowSource& out, const std::vector<bool>& replaced,
                          const PhaseProgress& progress,
                          const std::function<void(std::uint64_t row, Vec3 position)>& look);

}  // namespace pointsweep
