// SPDX-License-Identifier: MIT
/// Pictures of clouds of any size.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "pointsweep/formats/cloud.h"
#include "pointsweep/render/canvas.h"
#include "pointsweep/render/view.h"

namespace pointsweep {

struct RenderOptions {
  unsigned width = 1200, height = 900;  ///< pixels, 16 to 16,384 each and at most 2^26 together
  View view;
  std::string color;  ///< as PointColor takes it; empty: chosen
  Rgb background{255, 255, 255};
  /// Called after each block of points; may throw to end it. `phase` is "looking" or "drawing".
  std::function<void(const char* phase, std::uint64_t done, std::uint64_t total)> progress;
};

struct Rendering {
  Picture picture;
  std::string color;       ///< what gave the colours: "rgb", "height", "rms_curvature", ...
  bool is_number = false;  ///< whether they stand for numbers from lo (violet) to hi (yellow)
  double lo = 0, hi = 1;
};

/// Draws the cloud as opaque ellipses, orthographic, with a depth buffer. It is read twice from one end to the other:
/// for its bounds and a sample (framing, spacing of points, range of colours), then to be drawn. Memory: the picture
/// (24 to 96 bytes for each pixel) and 4 MB. The same file gives the same bytes. Without normals light comes from
/// differences of depth alone. Throws Error for a cloud without finite points, UsageError for options out of range.
Rendering render(Cloud& cloud, const RenderOptions& options);

}  // namespace pointsweep
