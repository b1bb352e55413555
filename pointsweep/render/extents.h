// SPDX-License-Identifier: MIT
/// Extents of a cloud along the axes of the pictures that may be made of it.
#pragma once

#include <optional>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/render/view.h"

namespace pointsweep {

/// Extents of a cloud along the axes of a camera, relative to the origin of the camera.
struct Extents {
  double lo_x = Box::kInf, hi_x = -Box::kInf, lo_y = Box::kInf, hi_y = -Box::kInf;
};

/// Takes the points while it is not known yet from where they will be seen: of each view that can be chosen, it finds
/// the extents of all points, not of a sample. Cost: two dot products a point and view, of which there are at most 12.
class PossibleViews {
 public:
  /// `angles`, `up`: those that are given; else any that is chosen from the shape.
  PossibleViews(std::optional<Angles> angles, std::optional<Up> up);
  void include(Vec3 p);
  /// Returns the extents for one of the possible views and a camera of that view.
  Extents extents(const View& view, const Camera& camera) const;

 private:
  struct Possible {
    View view;
    Camera camera;
    Extents extents;
  };
  std::optional<Vec3> origin_;  ///< the first point, so that map coordinates lose nothing
  std::vector<Possible> views_;
};

}  // namespace pointsweep
