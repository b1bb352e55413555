// SPDX-License-Identifier: MIT
/// The direction of view from the shape of a cloud, and the projection of points onto the picture.
#pragma once

#include <span>

#include "pointsweep/geometry.h"
#include "pointsweep/math/box.h"
#include "pointsweep/program/render.h"

namespace pointsweep {

/// The view from above, and a view that shows front, side and top of an object.
inline constexpr Angles kTop{0, 90}, kThreeQuarter{30, 25};

/// An orthographic camera: an orthonormal basis, and the part of the plane that the picture shows.
struct Camera {
  Vec3 right, up, toward;  ///< unit vectors of the picture's axes; `toward` points to the viewer
  Vec3 origin;             ///< point to which projections are relative, so that map coordinates lose no digits
  double center_x = 0, center_y = 0;  ///< middle of the picture along `right` and `up`, relative to `origin`
  double scale = 1;                   ///< pixels per unit of length
  double width = 0, height = 0;       ///< size of the picture in pixels

  /// Returns the place of `p`: x to the right and y down, in pixels from the upper left corner; z towards the viewer,
  /// in pixels.
  Vec3 project(Vec3 p) const {
    const Vec3 d = p - origin;
    return {0.5 * width + scale * (dot(d, right) - center_x), 0.5 * height - scale * (dot(d, up) - center_y),
            scale * dot(d, toward)};
  }
  /// Returns the projection of a difference of two points, in pixels.
  Vec3 project_offset(Vec3 d) const { return {scale * dot(d, right), -scale * dot(d, up), scale * dot(d, toward)}; }
};

/// Returns a camera whose center and scale are still to be set by frame(). Its vectors are made with plain operations,
/// so that pictures have the same bytes on every machine.
Camera camera_of(const View& view, Vec3 origin, unsigned width, unsigned height);

/// Chooses center and scale so that the box [lo, hi] along right and up is in the middle of the picture, as large as
/// the margins allow. The margin at each edge is 3 % of the width or height, at least `margin` pixels, at most 40 %.
void frame(Camera& camera, double lo_x, double hi_x, double lo_y, double hi_y, double margin = 0);

/// Returns whether the cloud's extent along `up` is at most a quarter of the geometric mean of its other two extents,
/// as in airborne scans and reliefs. Extents leave out 0.1 % of the points at either end.
bool is_flat(std::span<const Vec3> sample, Up up);

/// Returns the direction that points up in a cloud of unknown origin. In a flat cloud it is the positive axis
/// perpendicular to the cloud. Any other cloud is taken to stand on that of the six sides of its box which is covered
/// best by the points in the 2 % of the extent next to it: objects stand on a base or on feet, rooms and streets on a
/// floor. The covered share of a side is the area of the convex hull of these points, divided by the area of the side.
/// The share of the side below z is multiplied by 1.25, so that z wins if sides are similar; z also wins if no share is
/// above a quarter. Cost: a sort of the sample along each axis, and of the points next to each side.
Up find_up(std::span<const Vec3> sample);

}  // namespace pointsweep
