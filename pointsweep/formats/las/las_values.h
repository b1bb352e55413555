// SPDX-License-Identifier: MIT
/// What has to be known of all values of a cloud before its first point is stored as LAS.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "pointsweep/formats/cloud.h"
#include "pointsweep/formats/value_range.h"

namespace pointsweep {

struct LasValues {
  std::vector<ValueRange> ranges;  ///< one for each field of the cloud
  /// Real coordinates are stored at the scale of the inputs (Cloud::las()): every one of them lies on that grid, or all
  /// inputs are LAS and are rounded to the finest scale among them.
  bool keeps_grid = false;
  bool rounds = false;  ///< the latter
};

/// Reads the cloud once if the types of its fields leave open which point format holds them, or if real coordinates may
/// lie on the grid of the LAS file that they came from. `progress` gets the number of points read; it may throw.
LasValues las_values(Cloud& cloud, const std::function<void(std::uint64_t)>& progress);

}  // namespace pointsweep
