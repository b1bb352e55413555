// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/interpolation.h"

namespace pointsweep::formulas {

Estimate height_above(double z, std::span<const GroundPoint> nearest) {
  if (nearest.empty()) return {.value = {std::numeric_limits<Real>::quiet_NaN(), 0, 0}};
  if (nearest.front().distance2 == 0) return {.value = {z - nearest.front().z, 0, 0}};
  Real sum = 0, weights = 0, largest = 0;
  for (const GroundPoint& g : nearest) {
    const Real weight = 1 / static_cast<Real>(g.distance2);
    if (weight > 0x1p900L) return open();  // its products leave float64
    sum += weight * g.z, weights += weight;
    largest = std::max(largest, std::fabs(static_cast<Real>(g.z)));
  }
  const Real height = z - sum / weights;
  const Real error = rounding_of_sum(nearest.size()) * 2 * (largest + std::fabs(static_cast<Real>(z)));
  return {.value = {height, 0, 0}, .error = error};
}

}  // namespace pointsweep::formulas
