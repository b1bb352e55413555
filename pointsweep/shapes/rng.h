// SPDX-License-Identifier: MIT
/// Random numbers that belong to a point, not to a sequence: point i of seed S draws the same numbers always, so points
/// can be made in any order, on any thread, and again.
#pragma once

#include <cmath>
#include <cstdint>

#include "pointsweep/geometry.h"
#include "pointsweep/math/exp.h"

namespace pointsweep {

/// SplitMix64 (Steele, Lea, Flood: Fast Splittable Pseudorandom Number Generators, OOPSLA 2014) with one stream per
/// (seed, index): each has its own start and its own odd increment, as in split() of that paper.
class Rng {
 public:
  Rng(std::uint64_t seed, std::uint64_t index)
      : state_(mix(mix(seed + kGolden) + index * kGolden)), increment_(mix(state_ ^ kGolden) | 1) {}

  std::uint64_t next() { return mix(state_ += increment_); }
  /// Uniform in [0, 1), a multiple of 2^-53.
  double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

 private:
  static constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15;

  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }

  std::uint64_t state_, increment_;
};

// Directions and Gaussians by rejection (Marsaglia 1972), without a trigonometric function.

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

/// A smooth periodic wave without a trigonometric function: fast, and the same bytes on every processor.
struct WaveValue {
  double value;  ///< in [-1, 1]
  double slope;  ///< per period, in [-6.2, 6.2]
};

/// 32 u² (1-u)² - 1 for u in [0, 1), repeated: a cosine to the eye, twice continuously differentiable. |turns| < 2^50.
inline WaveValue wave(double turns) {
  const double shift = 0x1.8p52;                       // adding and taking it off rounds to a whole number
  const double v = turns - ((turns + shift) - shift);  // u - 1/2, in [-1/2, 1/2]
  const double w = 0.25 - v * v;                       // u (1 - u)
  return {32 * (w * w) - 1, -128 * (v * w)};
}

}  // namespace pointsweep
