// SPDX-License-Identifier: MIT
/// The shape that a generated cloud samples: a surface or a solid of known geometry, in metres.
#pragma once

#include <string>

#include "pointsweep/geometry.h"
#include "pointsweep/math/box.h"
#include "pointsweep/shapes/rng.h"

namespace pointsweep {

struct SurfacePoint {
  Vec3 position;
  Vec3 normal;  ///< unit, outward or upward; (0, 0, 0) for a shape without normals
};

class Shape {
 public:
  virtual ~Shape() = default;
  virtual std::string name() const = 0;
  /// One line for people: size and density.
  virtual std::string meaning() const = 0;
  virtual bool has_normals() const { return true; }
  /// Holds every point of the shape; not necessarily tight.
  virtual Box bounds() const = 0;
  /// One random point of the shape. Called from many threads at once.
  virtual SurfacePoint sample(Rng& rng) const = 0;
};

}  // namespace pointsweep
