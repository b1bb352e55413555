// SPDX-License-Identifier: MIT
/// The direction of view, chosen by the user or from the shape of the cloud, and the projection of points onto the
/// picture.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "pointsweep/geometry.h"
#include "pointsweep/math/box.h"

namespace pointsweep {

/// The direction that points up: an axis, or its opposite.
struct Up {
  int axis = 2;  ///< 0, 1, 2 for x, y, z
  int sign = 1;  ///< 1 or -1
  /// The coordinate of `p` along this direction.
  double height(Vec3 p) const { return sign * p[axis]; }
  friend bool operator==(const Up&, const Up&) = default;
};

/// The direction from which the viewer looks, in degrees. Azimuth 0 looks along +y with x to the right (the front), 90
/// from +x; elevation 90 looks down. With y up (as many scanned models are) the front looks along -z instead, with x up
/// along +z with y to the right. A negative axis turns the cloud upside down about the axis that points to the right.
struct Angles {
  double azimuth = 0, elevation = 0;
  friend bool operator==(const Angles&, const Angles&) = default;
};

struct View {
  Angles angles;
  Up up;
  friend bool operator==(const View&, const View&) = default;
};

/// The view from above, and a view that shows front, side and top of an object.
inline constexpr Angles kTop{0, 90}, kThreeQuarter{30, 25};

/// Parses "front", "top", "iso" or "AZIMUTH,ELEVATION" in degrees, |elevation| <= 90; none for "auto". Throws
/// UsageError.
std::optional<Angles> parse_view(std::string_view text);
/// Parses "x", "y", "z", "-x", "-y" or "-z"; none for "auto". Throws UsageError.
std::optional<Up> parse_up(std::string_view text);

/// An orthographic camera: an orthonormal basis, and the part of the plane that the picture shows.
struct Camera {
  Vec3 right, up, toward;  ///< unit vectors; `toward` the viewer
  Vec3 origin;             ///< world point that all projections are relative to, so that map coordinates lose nothing
  double center_x = 0, center_y = 0;  ///< middle of the picture, along right and up
  double scale = 1;                   ///< pixels per length
  double width = 0, height = 0;       ///< pixels

  /// x to the right and y down in pixels from the upper left corner; z in pixels towards the viewer.
  Vec3 project(Vec3 p) const {
    const Vec3 d = p - origin;
    return {0.5 * width + scale * (dot(d, right) - center_x), 0.5 * height - scale * (dot(d, up) - center_y),
            scale * dot(d, toward)};
  }
  /// Projects a difference of two points.
  Vec3 project_offset(Vec3 d) const { return {scale * dot(d, right), -scale * dot(d, up), scale * dot(d, toward)}; }
};

/// Returns a camera without a frame: center and scale are still to be chosen. Made with plain operations, so that
/// pictures are the same bytes on every machine.
Camera camera_of(const View& view, Vec3 origin, unsigned width, unsigned height);

/// Chooses center and scale so that the box [lo, hi] along right and up fills the picture up to a margin of 3 %, at
/// least `margin` pixels.
void frame(Camera& camera, double lo_x, double hi_x, double lo_y, double hi_y, double margin = 0);

/// True if the cloud's extent along `up` is at most a quarter of the geometric mean of the two others, as in airborne
/// scans and reliefs. Extents leave out 0.1 % of the points at either end.
bool is_flat(std::span<const Vec3> sample, Up up);

/// Finds the direction that points up in a cloud of unknown origin. In a flat cloud it is the positive axis
/// perpendicular to it. Other clouds stand on the side where the outermost 2 % of the extent cover the largest share of
/// that side (area of their convex hull over the area of the bounding rectangle): objects stand on a base or on feet,
/// rooms and streets on a floor. The share of z is multiplied by 1.25, so that z wins if sides are similar; it also
/// wins if no share reaches a quarter. Cost: a sort of the sample along each axis.
Up find_up(std::span<const Vec3> sample);

}  // namespace pointsweep
