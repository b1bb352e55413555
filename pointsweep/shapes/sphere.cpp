// SPDX-License-Identifier: MIT
#include "pointsweep/shapes/distributions.h"
#include "pointsweep/shapes/registry.h"

namespace pointsweep {
namespace {

class Sphere final : public Shape {
 public:
  std::string name() const override { return "sphere"; }
  std::string meaning() const override { return "radius 1 m, uniform"; }
  Box bounds() const override { return {{-1, -1, -1}, {1, 1, 1}}; }
  SurfacePoint sample(Rng& rng) const override {
    const Vec3 direction = on_sphere(rng);
    return {direction, direction};
  }
};

}  // namespace

std::unique_ptr<Shape> make_sphere() { return std::make_unique<Sphere>(); }

}  // namespace pointsweep
