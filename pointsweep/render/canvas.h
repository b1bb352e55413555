// SPDX-License-Identifier: MIT
/// A picture while it is drawn: colour and depth of every sample, and ellipses on it.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/program/render.h"

namespace pointsweep {

/// An ellipse in space as the camera sees it: x to the right, y down, z towards the viewer, in pixels.
struct ProjectedEllipse {
  Vec3 center;
  Vec3 u, v;  ///< semi-axes of the ellipse
  /// Distance in pixels by which the rim is farther from the viewer than the disc through the semi-axes, so that
  /// overlapping discs meet half-way.
  double bulge = 0;
};

/// A picture while it is drawn. Each sample keeps the nearest surface that was drawn on it; of equally near surfaces it
/// keeps the first. Memory: 8 bytes for each sample.
class Canvas {
 public:
  /// Makes an empty picture with fineness × fineness samples for each pixel.
  Canvas(unsigned width, unsigned height, unsigned fineness, Rgb background);

  /// Draws on the samples whose middle is inside of the ellipse, each with its own depth, and on the sample under the
  /// center, if it is in the picture; of an ellipse below a sixth of a sample in area, on that sample alone. Semi-axes
  /// are limited to an eighth of the picture's longer side, because a huge splat of an outlier would hide other points
  /// and take as much time as all other points together.
  void draw(const ProjectedEllipse& ellipse, Rgb color);

  /// Darkens samples that are farther from the viewer than some of the eight samples two pixels away: light and shade
  /// for points without normals (after the eye-dome lighting of Boucheny 2009, with 1/(1+x) for exp(-x)).
  void shade_by_depth();

  /// Returns the picture, with the mean of the samples of each pixel.
  Picture picture() const;

 private:
  struct Sample {
    float depth;
    Rgb color;
  };
  void put(std::int64_t x, std::int64_t y, double depth, Rgb color);

  unsigned width_, height_, fineness_;  ///< size of the picture in pixels, samples along a side of a pixel
  std::int64_t columns_, rows_;         ///< size of the picture in samples
  double longest_;                      ///< longest semi-axis that is drawn, in samples
  std::vector<Sample> samples_;
};

}  // namespace pointsweep
