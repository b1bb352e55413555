// SPDX-License-Identifier: MIT
/// Where the points of consecutive rows lie, as a file states it.
#pragma once

#include <cstdint>

#include "pointsweep/math/box.h"

namespace pointsweep {

/// The rows [first_row, first_row + rows) and a box that is said to hold their points: a hint, not to be trusted.
struct RowBox {
  std::uint64_t first_row = 0, rows = 0;
  Box box;
};

}  // namespace pointsweep
