// SPDX-License-Identifier: MIT
/// Bounding boxes that a file states for the points of consecutive rows.
#pragma once

#include <cstdint>

#include "pointsweep/math/box.h"

namespace pointsweep {

/// The rows [first_row, first_row + rows) and the box that the file states for their points. The box is not checked:
/// points may lie outside.
struct RowBox {
  std::uint64_t first_row = 0, rows = 0;
  Box box;
};

}  // namespace pointsweep
