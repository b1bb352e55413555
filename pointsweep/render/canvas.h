// SPDX-License-Identifier: MIT
/// The picture while it is drawn: colour and depth of every sample, and ellipses on it; the picture as PNG.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "pointsweep/colors/color_map.h"
#include "pointsweep/geometry.h"

namespace pointsweep {

/// width×height pixels of three bytes, rows from the top.
struct Picture {
  unsigned width = 0, height = 0;
  std::vector<Rgb> pixels;
};

/// An ellipse in space as the camera sees it: x to the right, y down, z towards the viewer, in pixels.
struct ProjectedEllipse {
  Vec3 center;
  Vec3 u, v;         ///< semi-axes
  double bulge = 0;  ///< how much farther from the viewer the rim is than the center, so that overlapping discs meet
                     ///< half-way
};

/// A picture while it is drawn. Each sample keeps the nearest of the surfaces drawn on it; of equally near ones the
/// first. Memory: 8 bytes × samples per pixel².
class Canvas {
 public:
  /// `fineness`² samples for each pixel.
  Canvas(unsigned width, unsigned height, unsigned fineness, Rgb background);

  /// Fills the samples whose middle is inside, each with its own depth; at least the sample under the center, unless
  /// that is outside of the picture. Semi-axes are limited to an eighth of the picture's sides: an outlier's huge splat
  /// would hide the other points and take as much time as all of them.
  void draw(const ProjectedEllipse& ellipse, Rgb color);

  /// Darkens samples that are farther from the viewer than the samples around them: light and shade for points without
  /// normals (after the eye-dome lighting of Boucheny 2009, with 1/(1+x) for exp(-x)).
  void shade_by_depth();

  /// The mean of the samples of each pixel.
  Picture picture() const;

 private:
  struct Sample {
    float depth;
    Rgb color;
  };
  void put(std::int64_t x, std::int64_t y, double depth, Rgb color);

  unsigned width_, height_, fineness_;  ///< size of the picture in pixels; samples along a side of a pixel
  std::int64_t columns_, rows_;         ///< samples
  double longest_;                      ///< semi-axis, in samples
  std::vector<Sample> samples_;
};

/// A whole PNG file, 8 bits per channel, sRGB. Throws Error if the machine has no memory for it.
std::vector<std::byte> to_png(const Picture& picture);

/// Parses "white", "black" or RRGGBB in hexadecimal. Throws UsageError.
Rgb parse_color(std::string_view text);

}  // namespace pointsweep
