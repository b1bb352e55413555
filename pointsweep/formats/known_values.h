// SPDX-License-Identifier: MIT
/// What some formats have to know of all values of a cloud before its first point is written (Format::values).
#pragma once

#include <vector>

#include "pointsweep/formats/value_range.h"

namespace pointsweep {

struct KnownValues {
  std::vector<ValueRange> ranges;  ///< one for each field of the cloud
  /// Real coordinates are stored at the scale of the inputs (InputCloud::las()): every one of them lies on that grid,
  /// or all inputs are LAS and are rounded to the finest scale among them.
  bool keeps_grid = false;
  bool rounds = false;  ///< the latter
};

}  // namespace pointsweep
