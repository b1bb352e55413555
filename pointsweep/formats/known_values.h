// SPDX-License-Identifier: MIT
/// The properties of all values of a cloud that some formats need before the first point is written (Format::values).
#pragma once

#include <optional>
#include <vector>

#include "pointsweep/formats/las_scale.h"
#include "pointsweep/formats/value_range.h"

namespace pointsweep {

struct KnownValues {
  std::vector<ValueRange> ranges;  ///< one for each field of the cloud
  /// The grid on which LAS stores the coordinates: every one of them lies on it, or all inputs are LAS and their
  /// coordinates are rounded to the finest scale among them. Absent: they lie on no grid that is known.
  std::optional<LasQuantization> grid = std::nullopt;
  bool rounds = false;       ///< the coordinates are rounded to that grid
  bool by_decimals = false;  ///< the grid follows from the decimals of the coordinates; moved points have others
};

}  // namespace pointsweep
