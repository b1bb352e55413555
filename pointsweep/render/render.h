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
  /// None: a flat cloud is seen from above, any other from the front, a little from the side and from above (is_flat).
  std::optional<Angles> angles;
  std::optional<Up> up;     ///< none: z if all files are LAS, else found from the shape (find_up)
  std::string color;        ///< as PointColor takes it; empty: chosen
  double point_size = 0;    ///< diameter of every point in pixels; 0: as the file says, or from the spacing of points
  std::string length_unit;  ///< of the coordinates, for the legend, e.g. "m"; empty: not known
  bool legend = true;       ///< whether the picture says what its colours mean, if it is large enough for that
  Rgb background{255, 255, 255};
  /// Limit in seconds for reading and drawing, held approximately. Beyond the limit edges are coarser and only every
  /// n-th stretch of rows is drawn. 0: no limit.
  double seconds = 0;
  /// Called after each block of points; may throw to end it. `phase` is "looking" or "drawing".
  std::function<void(const char* phase, std::uint64_t done, std::uint64_t total)> progress;
};

struct Rendering {
  Picture picture;
  std::string color;       ///< what gave the colours: "rgb", "height", "rms_curvature", ...
  bool is_number = false;  ///< true if the colours stand for numbers from lo (violet) to hi (yellow)
  double lo = 0, hi = 1;
  View view{};                         ///< view that was used
  std::uint64_t points = 0;            ///< of the cloud
  std::uint64_t drawn = 0;             ///< that were looked at: all, but for levels and RenderOptions::seconds
  std::uint64_t outside = 0;           ///< points that lie so far from all others that the picture does not show them
  std::string remark = {};             ///< why the file's colours are not used although it has some; else empty
  std::vector<std::byte> sample = {};  ///< records of at most 65,536 of the points, evenly chosen
};

/// Draws the cloud as opaque ellipses, orthographic, with a depth buffer; edges are averaged over up to nine samples
/// for each pixel. All points are inside the picture but far outliers (Rendering::outside). The cloud is read twice
/// from one end to the other: for its extents and a sample (up, spacing, range of colours), then to be drawn. Memory:
/// the picture (11 to 75 bytes for each pixel), 4 MB and 65,536 records. Of COPC files it reads no finer levels of
/// detail than pixels show. The same file gives the same bytes. Without
/// normals, light comes from differences of depth alone. Throws Error for a cloud without finite points, UsageError for
/// options out of range.
Rendering render(InputCloud& cloud, const RenderOptions& options);

}  // namespace pointsweep
