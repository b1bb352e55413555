// SPDX-License-Identifier: MIT
/// Pictures of clouds of any size.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/formats/cloud/input_cloud.h"
#include "pointsweep/render/canvas.h"
#include "pointsweep/render/view.h"

namespace pointsweep {

struct RenderOptions {
  unsigned width = 1200, height = 900;  ///< pixels, 16 to 16,384 each and at most 2^26 together
  /// Absent: a flat cloud is seen from above, any other from the front, a little from the side and from above
  /// (is_flat).
  std::optional<Angles> angles;
  std::optional<Up> up;     ///< absent: z if all files are LAS, else found from the shape (find_up)
  std::string color;        ///< in the syntax of PointColor; empty: chosen
  double point_size = 0;    ///< diameter of every point in pixels; 0: from the file, or from the spacing of points
  std::string length_unit;  ///< unit of the coordinates for the legend, e.g. "m"; empty: unknown
  bool legend = true;       ///< draw a legend of the colours if the picture is large enough
  Rgb background{255, 255, 255};
  /// Limit in seconds for reading and drawing, held approximately. Beyond the limit edges are coarser and only every
  /// n-th stretch of rows is drawn. 0: no limit.
  double seconds = 0;
  /// Called after each block of points; may throw to end it. `phase` is "looking" or "drawing".
  std::function<void(const char* phase, std::uint64_t done, std::uint64_t total)> progress;
};

struct Rendering {
  Picture picture;
  std::string color;       ///< source of the colours: "rgb", "height", "rms_curvature", ...
  bool is_number = false;  ///< the colours show numbers from lo (violet) to hi (yellow)
  double lo = 0, hi = 1;
  View view{};                         ///< view that was used
  std::uint64_t points = 0;            ///< points of the cloud
  std::uint64_t drawn = 0;             ///< points read: all, except with levels and RenderOptions::seconds
  std::uint64_t outside = 0;           ///< points too far from all others to be in the picture
  std::string remark = {};             ///< why the colours of the file are not used; empty if it has none or they are
                                       ///< used
  std::vector<std::byte> sample = {};  ///< records of at most 65,536 of the points, evenly chosen
};

/// Draws the cloud as opaque ellipses, orthographic, with a depth buffer; edges are averaged over up to nine samples
/// for each pixel. All points except far outliers (Rendering::outside) are inside the picture. The cloud is read twice:
/// for its extents and a sample (up, spacing, range of colours), then for drawing. Memory: the picture (11 to 75 bytes
/// for each pixel), 4 MB and 65,536 records. Of COPC files it reads no finer levels of detail than pixels show. The
/// same file gives the same bytes. Without normals, shading follows only from differences of depth. Throws Error for a
/// cloud without finite points, UsageError for options out of range.
Rendering render(InputCloud& cloud, const RenderOptions& options);

}  // namespace pointsweep
