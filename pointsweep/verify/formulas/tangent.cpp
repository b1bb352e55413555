// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/tangent.h"

namespace pointsweep::formulas {

Estimate tangent(Vector n, Vector along, Vector across, Real error) {
  const Real lift = dot(n, along), lift_across = dot(n, across);
  const Vector flat = along - lift * n, turned = cross(across, n);
  const bool projected = std::fabs(lift) <= std::fabs(lift_across);
  const Vector chosen = projected ? flat : turned;
  Estimate t{.value = unit(chosen), .error = 2 * error / norm(chosen), .either_sign = true};
  if (std::fabs(std::fabs(lift) - std::fabs(lift_across)) <= 4 * error) {  // either may decide
    const Vector other = unit(projected ? turned : flat);
    t.error += std::min(norm(t.value - other), norm(t.value + other));
  }
  if (!(t.error < 1)) t.error = kInfinity;
  return t;
}

}  // namespace pointsweep::formulas
