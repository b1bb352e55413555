// SPDX-License-Identifier: MIT
/// Boxes that a file states for the points of consecutive rows.
#pragma once

#include <cstdint>

#include "pointsweep/math/box.h"

namespace pointsweep {

/// The rows [first_row, first_row + rows) and a stated box of their points, which may be wrong.
struct RowBox {
  std::uint64_t first_row = 0, rows = 0;
  Box box;
};

}  // namespace pointsweep
