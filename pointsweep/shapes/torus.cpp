// SPDX-License-Identifier: MIT
#include "pointsweep/shapes/distributions.h"
#include "pointsweep/shapes/registry.h"

namespace pointsweep {
namespace {

constexpr double kRing = 1;
constexpr double kTube = 0.3;

class Torus final : public Shape {
 public:
  std::string name() const override { return "torus"; }
  std::string meaning() const override { return "around z, radius of the ring 1 m, of the tube 0.3 m, uniform"; }
  Box bounds() const override {
    const double reach = kRing + kTube;
    return {{-reach, -reach, -kTube}, {reach, reach, kTube}};
  }
  SurfacePoint sample(Rng& rng) const override {
    const Vec2 around_ring = on_circle(rng);
    Vec2 around_tube = on_circle(rng);
    // The outer side has more area than the inner one, in proportion to the distance from the axis.
    while (rng.uniform() * (kRing + kTube) > kRing + kTube * around_tube.x) around_tube = on_circle(rng);
    const double distance = kRing + kTube * around_tube.x;
    return {{distance * around_ring.x, distance * around_ring.y, kTube * around_tube.y},
            {around_tube.x * around_ring.x, around_tube.x * around_ring.y, around_tube.y}};
  }
};

}  // namespace

std::unique_ptr<Shape> make_torus() { return std::make_unique<Torus>(); }

}  // namespace pointsweep
