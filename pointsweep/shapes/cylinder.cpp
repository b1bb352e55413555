// SPDX-License-Identifier: MIT
#include "pointsweep/shapes/distributions.h"
#include "pointsweep/shapes/registry.h"

namespace pointsweep {
namespace {

constexpr double kRadius = 0.5;
constexpr double kHalfHeight = 1;

class Cylinder final : public Shape {
 public:
  std::string name() const override { return "cylinder"; }
  std::string meaning() const override { return "open, around z, radius 0.5 m, height 2 m, uniform"; }
  Box bounds() const override { return {{-kRadius, -kRadius, -kHalfHeight}, {kRadius, kRadius, kHalfHeight}}; }
  SurfacePoint sample(Rng& rng) const override {
    const Vec2 c = on_circle(rng);
    return {{kRadius * c.x, kRadius * c.y, rng.uniform(-kHalfHeight, kHalfHeight)}, {c.x, c.y, 0}};
  }
};

}  // namespace

std::unique_ptr<Shape> make_cylinder() { return std::make_unique<Cylinder>(); }

}  // namespace pointsweep
