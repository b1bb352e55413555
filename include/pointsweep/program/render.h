// SPDX-License-Identifier: MIT
/// Pictures of clouds of any size. Programs that include this header link pointsweep::render.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/cloud.h"
#include "pointsweep/export.h"
#include "pointsweep/geometry.h"
#include "pointsweep/program/color.h"

namespace pointsweep {

/// A finished picture: width×height pixels of three bytes, row by row from the top.
struct Picture {
  unsigned width = 0, height = 0;
  std::vector<Rgb> pixels;
};

/// The direction that points up: an axis, or its opposite.
struct Up {
  int axis = 2;  ///< number of the axis: 0, 1 or 2 for x, y or z
  int sign = 1;  ///< 1 for the axis, -1 for its opposite
  /// Returns the coordinate of `p` along this direction.
  double height(Vec3 p) const { return sign * p[axis]; }
  friend bool operator==(const Up&, const Up&) = default;
};

/// The direction of view, in degrees. At azimuth 0 the viewer looks along +y with x to the right (the front), at
/// azimuth 90 from +x; at elevation 90 the viewer looks down. If y points up, as in many scanned models, the front view
/// looks along -z with x to the right; if x points up, along +z with y to the right. A negative direction up turns the
/// cloud upside down about the axis that points to the right.
struct Angles {
  double azimuth = 0, elevation = 0;
  friend bool operator==(const Angles&, const Angles&) = default;
};

struct View {
  Angles angles;
  Up up;
  friend bool operator==(const View&, const View&) = default;
};

struct RenderOptions {
  unsigned width = 1200, height = 900;  ///< pixels, 16 to 16,384 each and at most 2^26 together
  /// Direction of view. If absent, a flat cloud is seen from above, any other from the front, a little from
  /// the side and from above.
  std::optional<Angles> angles = {};
  std::optional<Up> up = {};  ///< direction up; if absent, z if all files are LAS, else found from the shape
  std::string color = {};     ///< colouring as --color of the tool names it; empty for an automatic choice
  double point_size = 0;      ///< diameter of every point in pixels; 0 for sizes from the file or the spacing of points
  std::string length_unit = {};  ///< unit of the coordinates for the legend, e.g. "m"; empty if unknown
  bool legend = true;            ///< true to draw a legend of the colours if the picture is large enough
  Rgb background{255, 255, 255};
  /// Approximate limit in seconds for reading and drawing. To keep it, edges are drawn coarser and only every n-th
  /// stretch of rows is drawn. 0 for no limit.
  double seconds = 0;
  /// Called after each block of points; may throw to end the drawing. `phase` is "looking" or "drawing".
  std::function<void(const char* phase, std::uint64_t done, std::uint64_t total)> progress = {};
};

struct Rendering {
  Picture picture;
  std::string color;       ///< source of the colours: "rgb", "height", "rms_curvature", ...
  bool is_number = false;  ///< true if the colours show numbers from `lo` (violet) to `hi` (yellow)
  double lo = 0, hi = 1;
  View view{};                ///< view that was used
  std::uint64_t points = 0;   ///< number of points of the cloud
  std::uint64_t drawn = 0;    ///< number of points read; fewer than all with levels of detail or a time limit
  std::uint64_t outside = 0;  ///< number of points outside of the picture, since they are too far from all others
  std::string remark = {};    ///< note if the colours of the file were to be drawn but are all equal; else empty
  std::vector<std::byte> sample = {};  ///< records of at most 65,536 of the points, evenly chosen
};

/// Draws the cloud as opaque ellipses, orthographic, with a depth buffer; edges are averaged over up to nine samples
/// for each pixel. All points except far outliers (Rendering::outside) are inside the picture. The cloud is read twice:
/// for its extents and a sample (direction up, spacing, range of colours), then for drawing. Memory: the picture (11 to
/// 75 bytes for each pixel), 4 MB and 65,536 records. COPC files are read only down to the level of detail that pixels
/// show. Equal files give equal bytes. Without normals, shading depends only on differences of depth. Throws Error for
/// a cloud without finite points, UsageError for options out of range.
POINTSWEEP_EXPORT Rendering render(Cloud& cloud, const RenderOptions& options);

/// Returns a whole PNG file, 8 bits per channel, sRGB. Throws Error if the machine has not enough memory.
POINTSWEEP_EXPORT std::vector<std::byte> to_png(const Picture& picture);

/// Parses "white", "black" or RRGGBB in hexadecimal. Throws UsageError.
POINTSWEEP_EXPORT Rgb parse_color(std::string_view text);

/// Parses "front", "top", "iso" or "AZIMUTH,ELEVATION" in degrees, |elevation| <= 90; nullopt for "auto". Throws
/// UsageError.
POINTSWEEP_EXPORT std::optional<Angles> parse_view(std::string_view text);
/// Parses "x", "y", "z", "-x", "-y" or "-z"; nullopt for "auto". Throws UsageError.
POINTSWEEP_EXPORT std::optional<Up> parse_up(std::string_view text);

}  // namespace pointsweep
