// SPDX-License-Identifier: MIT
/// Covariances: symmetric matrices summed from vectors.
#pragma once

#include "pointsweep/geometry.h"
#include "pointsweep/math/symmetric3.h"

namespace pointsweep {

/// m += weight v v^T
inline void add_outer_product(Symmetric3& m, double weight, Vec3 v) {
  const Vec3 t = weight * v;
  m.xx += t.x * v.x, m.xy += t.x * v.y, m.xz += t.x * v.z;
  m.yy += t.y * v.y, m.yz += t.y * v.z, m.zz += t.z * v.z;
}

}  // namespace pointsweep
