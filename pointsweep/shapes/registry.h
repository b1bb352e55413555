// SPDX-License-Identifier: MIT
/// The shapes that can be generated, by name. A new shape is a class in registry.cpp, or a source file with its maker
/// below, and a line in all_shapes().
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/math/box.h"
#include "pointsweep/shapes/rng.h"

namespace pointsweep {

struct SurfacePoint {
  Vec3 position;
  Vec3 normal;  ///< unit normal, outward or upward; (0, 0, 0) for a shape without normals and for an outlier
};

/// The shape that a generated cloud samples: a surface or a solid of known geometry, in metres.
class Shape {
 public:
  virtual ~Shape() = default;
  virtual std::string name() const = 0;
  /// Returns one line about size and density.
  virtual std::string meaning() const = 0;
  virtual bool has_normals() const { return true; }
  /// Returns a box that contains every point of the shape; it need not be tight.
  virtual Box bounds() const = 0;
  /// Returns a random point of the shape. Called from many threads at once.
  virtual SurfacePoint sample(Rng& rng) const = 0;
};

std::unique_ptr<Shape> make_statue();
std::unique_ptr<Shape> make_terrain();
std::unique_ptr<Shape> make_tls();

/// Returns one shape of each kind, in the order of their presentation.
std::vector<std::unique_ptr<Shape>> all_shapes();
/// Returns the shape with this name. Throws UsageError, which lists the known names, if there is none.
std::unique_ptr<Shape> create_shape(std::string_view name);

}  // namespace pointsweep
