// SPDX-License-Identifier: MIT
/// Random numbers that depend on a seed and the index of a point alone, so that points can be made in any order, on any
/// thread, and more than once; and a periodic function for shapes.
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
  /// Returns a uniform value in [0, 1), a multiple of 2^-53.
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

// The next functions draw directions and Gaussians by rejection (Marsaglia 1972), without a trigonometric function.

struct Vec2 {
  double x = 0, y = 0;
};

/// Returns a uniform point in the unit disc without its centre; its squared radius is uniform in (0, 1).
inline Vec2 in_disc(Rng& rng) {
  for (;;) {
    const Vec2 p{rng.uniform(-1, 1), rng.uniform(-1, 1)};
    const double radius2 = p.x * p.x + p.y * p.y;
    if (radius2 < 1 && radius2 > 0) return p;
  }
}

/// Returns a uniform point on the unit circle.
inline Vec2 on_circle(Rng& rng) {
  const Vec2 p = in_disc(rng);
  const double radius = std::sqrt(p.x * p.x + p.y * p.y);
  return {p.x / radius, p.y / radius};
}

/// Returns a uniform point on the unit sphere.
inline Vec3 on_sphere(Rng& rng) {
  const Vec2 p = in_disc(rng);
  const double radius2 = p.x * p.x + p.y * p.y, stretch = 2 * std::sqrt(1 - radius2);
  return {stretch * p.x, stretch * p.y, 1 - 2 * radius2};
}

/// Returns two independent Gaussian values of mean 0 and standard deviation 1.
inline Vec2 gaussian_pair(Rng& rng) {
  const Vec2 p = in_disc(rng);
  const double radius2 = p.x * p.x + p.y * p.y, stretch = std::sqrt(-2 * natural_logarithm(radius2) / radius2);
  return {stretch * p.x, stretch * p.y};
}

/// A value of wave(), a smooth periodic function without trigonometry, which is equal to the bit on every processor.
struct WaveValue {
  double value;  ///< in [-1, 1]
  double slope;  ///< change of the value per period, in [-6.2, 6.2]
};

/// Returns 32 u² (1-u)² - 1 and its slope, where u in [0, 1] is the fraction of `turns` + 1/2: a periodic function that
/// looks like a cosine and is twice continuously differentiable. |turns| must be below 2^50.
inline WaveValue wave(double turns) {
  const double shift = 0x1.8p52;                       // adding and subtracting it rounds to a whole number
  const double v = turns - ((turns + shift) - shift);  // u - 1/2, in [-1/2, 1/2]
  const double w = 0.25 - v * v;                       // u (1 - u)
  return {32 * (w * w) - 1, -128 * (v * w)};
}

}  // namespace pointsweep
