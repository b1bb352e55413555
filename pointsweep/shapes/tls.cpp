// SPDX-License-Identifier: MIT
/// A terrestrial scan of a square from one station. The directions of rays are uniform on the sphere, so that density
/// falls with the square of the distance, and further where rays meet a surface at a flat angle.
#include <array>
#include <limits>

#include "pointsweep/shapes/registry.h"
#include "pointsweep/shapes/rng.h"

namespace pointsweep {
namespace {

constexpr double kGround = -1.7;                   // height of the ground in metres; the station is the origin
constexpr double kReach = 100;                     // longest ray in metres
constexpr double kSteepest = -0.8660254037844386;  // sine of -60 degrees; steeper rays would meet the tripod
constexpr double kNever = std::numeric_limits<double>::infinity();

/// A house, which is higher than the station, so that only its walls are seen.
struct Block {
  Vec2 center, axis;  ///< center on the map, and unit vector along u
  double half_u, half_v, top;
};
/// A round pillar, higher than the station.
struct Pillar {
  Vec2 center;
  double radius, top;
};
struct Hit {
  double distance = kNever;
  Vec3 normal;
};

constexpr std::array<Block, 7> kBlocks{{{{22, 4}, {0.96, 0.28}, 5, 14, 9},
                                        {{-14, 17}, {0.8, -0.6}, 9, 4, 7},
                                        {{-30, -12}, {0.28, 0.96}, 16, 6, 14},
                                        {{6, -34}, {1, 0}, 20, 8, 11},
                                        {{30, 55}, {0.6, 0.8}, 18, 10, 25},
                                        {{-45, 50}, {0.96, -0.28}, 14, 11, 18},
                                        {{62, -40}, {0.8, 0.6}, 15, 12, 30}}};
constexpr std::array<Pillar, 10> kPillars{{{{4, 3}, 0.35, 5},
                                           {{6, 6}, 0.35, 5},
                                           {{8, 9}, 0.35, 5},
                                           {{-5, 4}, 0.35, 5},
                                           {{-7, 7.5}, 0.35, 5},
                                           {{2.5, -3}, 0.06, 4},
                                           {{-9, -6}, 0.06, 7},
                                           {{12, -15}, 0.06, 7},
                                           {{-3, -13}, 0.6, 3},
                                           {{0, 30}, 1.5, 12}}};

void meet(const Block& b, Vec3 d, Hit& hit) {
  const Vec2 from{-(b.center.x * b.axis.x + b.center.y * b.axis.y), -(b.center.y * b.axis.x - b.center.x * b.axis.y)};
  const Vec2 ray{d.x * b.axis.x + d.y * b.axis.y, d.y * b.axis.x - d.x * b.axis.y};
  // The station is outside: the ray enters through the farther of the two walls that face the station.
  const double u = ray.x == 0 ? -kNever : ((ray.x > 0 ? -b.half_u : b.half_u) - from.x) / ray.x;
  const double v = ray.y == 0 ? -kNever : ((ray.y > 0 ? -b.half_v : b.half_v) - from.y) / ray.y;
  const bool through_u = u > v;
  const double t = through_u ? u : v;
  if (!(t > 0 && t < hit.distance) || t * d.z > b.top) return;
  const double aside = through_u ? from.y + t * ray.y : from.x + t * ray.x;
  if (std::abs(aside) > (through_u ? b.half_v : b.half_u)) return;
  const Vec2 n = through_u ? Vec2{ray.x > 0 ? -1.0 : 1.0, 0} : Vec2{0, ray.y > 0 ? -1.0 : 1.0};
  hit = {t, {n.x * b.axis.x - n.y * b.axis.y, n.x * b.axis.y + n.y * b.axis.x, 0}};
}

void meet(const Pillar& p, Vec3 d, Hit& hit) {
  // Solves |t (d.x, d.y) - center| = radius for the nearer t.
  const double a = d.x * d.x + d.y * d.y, half_b = d.x * p.center.x + d.y * p.center.y;
  const double c = p.center.x * p.center.x + p.center.y * p.center.y - p.radius * p.radius;
  const double discriminant = half_b * half_b - a * c;
  if (half_b <= 0 || discriminant <= 0) return;
  const double t = c / (half_b + std::sqrt(discriminant));
  if (t >= hit.distance || t * d.z > p.top) return;
  hit = {t, {(t * d.x - p.center.x) / p.radius, (t * d.y - p.center.y) / p.radius, 0}};
}

class Tls final : public Shape {
 public:
  std::string name() const override { return "tls"; }
  std::string meaning() const override {
    return "terrestrial scan of a square, station at the origin, reach 100 m, density as 1/r^2";
  }
  Box bounds() const override { return {{-kReach, -kReach, -2}, {kReach, kReach, 30}}; }

  SurfacePoint sample(Rng& rng) const override {
    for (;;) {
      const Vec3 d = on_sphere(rng);
      if (d.z < kSteepest) continue;
      Hit hit;
      if (d.z < 0) hit = {kGround / d.z, {0, 0, 1}};
      for (const Block& block : kBlocks) meet(block, d, hit);
      for (const Pillar& pillar : kPillars) meet(pillar, d, hit);
      if (hit.distance <= kReach) return {hit.distance * d, hit.normal};
    }
  }
};

}  // namespace

std::unique_ptr<Shape> make_tls() { return std::make_unique<Tls>(); }

}  // namespace pointsweep
