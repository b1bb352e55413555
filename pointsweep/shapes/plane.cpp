// SPDX-License-Identifier: MIT
#include "pointsweep/shapes/registry.h"

namespace pointsweep {
namespace {

class Plane final : public Shape {
 public:
  std::string name() const override { return "plane"; }
  std::string meaning() const override { return "square of 1 m in z = 0, uniform"; }
  Box bounds() const override { return {{-0.5, -0.5, 0}, {0.5, 0.5, 0}}; }
  SurfacePoint sample(Rng& rng) const override {
    const double x = rng.uniform(-0.5, 0.5), y = rng.uniform(-0.5, 0.5);
    return {{x, y, 0}, {0, 0, 1}};
  }
};

}  // namespace

std::unique_ptr<Shape> make_plane() { return std::make_unique<Plane>(); }

}  // namespace pointsweep
