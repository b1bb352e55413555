// SPDX-License-Identifier: MIT
/// Vector attributes, and unit vectors from them, for operators that read normals.
#pragma once

#include <array>
#include <cmath>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// A vector attribute of a point, N×3 f32.
using Float3 = std::array<float, 3>;

/// Returns v / |v|, or (0, 0, 0) if v is 0 or not finite.
inline Vec3 unit_or_zero(Vec3 v) {
  const double size = length(v);
  return size > 0 && std::isfinite(size) ? (1 / size) * v : Vec3{};
}
inline Vec3 unit_or_zero(Float3 v) { return unit_or_zero(Vec3{v[0], v[1], v[2]}); }

}  // namespace pointsweep
