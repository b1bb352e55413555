// SPDX-License-Identifier: MIT
#include "pointsweep/shapes/registry.h"

namespace pointsweep {
namespace {

class Volume final : public Shape {
 public:
  std::string name() const override { return "volume"; }
  std::string meaning() const override { return "solid cube of 1 m, uniform; no normals"; }
  bool has_normals() const override { return false; }
  Box bounds() const override { return {{0, 0, 0}, {1, 1, 1}}; }
  SurfacePoint sample(Rng& rng) const override {
    const double x = rng.uniform(), y = rng.uniform(), z = rng.uniform();
    return {{x, y, z}, {}};
  }
};

}  // namespace

std::unique_ptr<Shape> make_volume() { return std::make_unique<Volume>(); }

}  // namespace pointsweep
