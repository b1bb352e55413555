// SPDX-License-Identifier: MIT
/// Directions and Gaussians by rejection (Marsaglia 1972), without a trigonometric function.
#pragma once

#include <cmath>

#include "pointsweep/geometry.h"
#include "pointsweep/math/natural_logarithm.h"
#include "pointsweep/shapes/rng.h"

namespace pointsweep {

struct Vec2 {
  double x = 0, y = 0;
};

/// Uniform in the unit disc without its centre; the squared radius is uniform in (0, 1).
inline Vec2 in_disc(Rng& rng) {
  for (;;) {
    const Vec2 p{rng.uniform(-1, 1), rng.uniform(-1, 1)};
    const double radius2 = p.x * p.x + p.y * p.y;
    if (radius2 < 1 && radius2 > 0) return p;
  }
}

/// Uniform on the unit circle.
inline Vec2 on_circle(Rng& rng) {
  const Vec2 p = in_disc(rng);
  const double radius = std::sqrt(p.x * p.x + p.y * p.y);
  return {p.x / radius, p.y / radius};
}

/// Uniform on the unit sphere.
inline Vec3 on_sphere(Rng& rng) {
  const Vec2 p = in_disc(rng);
  const double radius2 = p.x * p.x + p.y * p.y, stretch = 2 * std::sqrt(1 - radius2);
  return {stretch * p.x, stretch * p.y, 1 - 2 * radius2};
}

/// Two independent values of mean 0 and standard deviation 1.
inline Vec2 gaussian_pair(Rng& rng) {
  const Vec2 p = in_disc(rng);
  const double radius2 = p.x * p.x + p.y * p.y, stretch = std::sqrt(-2 * natural_logarithm(radius2) / radius2);
  return {stretch * p.x, stretch * p.y};
}

}  // namespace pointsweep
