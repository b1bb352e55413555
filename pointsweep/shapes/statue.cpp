// SPDX-License-Identifier: MIT
/// A closed bumpy surface: a sphere whose radius carries waves of four octaves, stretched to about the height of a
/// person.
#include <algorithm>
#include <array>

#include "pointsweep/shapes/registry.h"
#include "pointsweep/shapes/rng.h"

namespace pointsweep {
namespace {

constexpr int kOctaves = 4, kWavesPerOctave = 4, kWaves = kOctaves * kWavesPerOctave;
constexpr std::array<double, kOctaves> kFrequency{0.35, 0.8, 1.8, 4.0};        // periods per unit of direction
constexpr std::array<double, kOctaves> kAmplitude{0.09, 0.035, 0.012, 0.004};  // amplitude of each wave, in radii
constexpr Vec3 kStretch{0.5, 0.4, 0.9};
constexpr std::uint64_t kStatueSeed = 2005;
constexpr int kProbes = 1 << 14;

/// The radius and its gradient at a direction d: r(d) = 1 + Σ amplitude · wave(f · d + phase) over all waves (rng.h).
struct Relief {
  double radius;
  Vec3 gradient;
};

class Statue final : public Shape {
 public:
  Statue() {
    Rng rng(kStatueSeed, 0);
    for (int w = 0; w < kWaves; ++w) {
      const Vec3 f = kFrequency[w / kWavesPerOctave] * on_sphere(rng);
      fx_[w] = f.x, fy_[w] = f.y, fz_[w] = f.z;
      phase_[w] = rng.uniform();
      amplitude_[w] = kAmplitude[w / kWavesPerOctave];
    }
    for (int i = 0; i < kProbes; ++i) {
      const Vec3 a = area_vector(on_sphere(rng));
      most_area2_ = std::max(most_area2_, dot(a, a));
    }
    most_area2_ *= 1.1;  // the maximum may be a little above the largest probe
  }

  std::string name() const override { return "statue"; }
  std::string meaning() const override { return "closed bumpy surface 2 m high, nearly uniform"; }
  Box bounds() const override {
    double reach = 1;
    for (const double a : amplitude_) reach += a;
    return {(-reach) * kStretch, reach * kStretch};
  }

  SurfacePoint sample(Rng& rng) const override {
    for (;;) {
      const Vec3 d = on_sphere(rng);
      const Relief relief = relief_at(d);
      const Vec3 area = area_vector(d, relief);
      const double area2 = dot(area, area), chance = rng.uniform();
      if (chance * chance * most_area2_ > area2) continue;
      return {{relief.radius * kStretch.x * d.x, relief.radius * kStretch.y * d.y, relief.radius * kStretch.z * d.z},
              (1 / std::sqrt(area2)) * area};
    }
  }

 private:
  Relief relief_at(Vec3 d) const {
    Relief relief{1, {}};
    for (int w = 0; w < kWaves; ++w) {
      const WaveValue value = wave(fx_[w] * d.x + fy_[w] * d.y + fz_[w] * d.z + phase_[w]);
      relief.radius += amplitude_[w] * value.value;
      relief.gradient = relief.gradient + (amplitude_[w] * value.slope) * Vec3{fx_[w], fy_[w], fz_[w]};
    }
    return relief;
  }

  /// Returns the outward normal times surface area per solid angle. Before the stretch S it is r² d - r g, where g is
  /// the part of the gradient perpendicular to d; the stretch maps it by the cofactors of S.
  static Vec3 area_vector(Vec3 d, const Relief& relief) {
    const Vec3 across = relief.gradient - dot(relief.gradient, d) * d;
    const Vec3 a = (relief.radius * relief.radius) * d - relief.radius * across;
    return {kStretch.y * kStretch.z * a.x, kStretch.x * kStretch.z * a.y, kStretch.x * kStretch.y * a.z};
  }
  Vec3 area_vector(Vec3 d) const { return area_vector(d, relief_at(d)); }

  std::array<double, kWaves> fx_{}, fy_{}, fz_{}, phase_{}, amplitude_{};
  double most_area2_ = 0;
};

}  // namespace

std::unique_ptr<Shape> make_statue() { return std::make_unique<Statue>(); }

}  // namespace pointsweep
