// SPDX-License-Identifier: MIT
#include "pointsweep/shapes/registry.h"

#include "pointsweep/fail.h"

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
    // The area of the outer side exceeds the area of the inner side, in proportion to the distance from the axis.
    while (rng.uniform() * (kRing + kTube) > kRing + kTube * around_tube.x) around_tube = on_circle(rng);
    const double distance = kRing + kTube * around_tube.x;
    return {{distance * around_ring.x, distance * around_ring.y, kTube * around_tube.y},
            {around_tube.x * around_ring.x, around_tube.x * around_ring.y, around_tube.y}};
  }
};

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

std::vector<std::unique_ptr<Shape>> all_shapes() {
  std::vector<std::unique_ptr<Shape>> shapes;
  shapes.push_back(std::make_unique<Plane>());
  shapes.push_back(std::make_unique<Sphere>());
  shapes.push_back(std::make_unique<Cylinder>());
  shapes.push_back(std::make_unique<Torus>());
  shapes.push_back(make_statue());
  shapes.push_back(make_terrain());
  shapes.push_back(make_tls());
  shapes.push_back(std::make_unique<Volume>());
  return shapes;
}

std::unique_ptr<Shape> create_shape(std::string_view name) {
  std::string known;
  for (auto& shape : all_shapes()) {
    if (shape->name() == name) return std::move(shape);
    known += (known.empty() ? "" : ", ") + shape->name();
  }
  fail_usage("no shape is called '{}'; choose one of {}.", name, known);
}

}  // namespace pointsweep
