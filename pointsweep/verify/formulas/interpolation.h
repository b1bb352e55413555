// SPDX-License-Identifier: MIT
/// Height above points of the ground.
#pragma once

#include <span>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

struct GroundPoint {
  double distance2;  ///< in the plane
  double z;
};

/// z - Σ w_j z_j / Σ w_j, w_j = 1 / d_j², of `nearest`, the nearest first; z - z_1 where d_1 = 0; NaN without any.
Estimate height_above(double z, std::span<const GroundPoint> nearest);

}  // namespace pointsweep::formulas
