// SPDX-License-Identifier: MIT
/// Text in pictures: letters made of strokes, of any size, with smooth edges.
#pragma once

#include <string_view>

#include "pointsweep/render/canvas.h"

namespace pointsweep {

/// Printable ASCII; any other byte is drawn as '?'.
class Lettering {
 public:
  /// `capital` is the height of a capital letter in pixels.
  Lettering(double capital, Rgb color) : unit_(capital / 6), color_(color) {}

  /// Pixels from the left edge of the first letter to the right edge of the last.
  double width(std::string_view text) const;
  /// Pixels from one baseline to the next.
  double line_height() const { return 11 * unit_; }
  double capital() const { return 6 * unit_; }

  /// Draws the text with its left end at `x` and its baseline at `baseline`, in pixels from the upper left corner. What
  /// falls outside of the picture is cut off.
  void draw(Picture& picture, double x, double baseline, std::string_view text) const;

 private:
  double unit_;  ///< pixels: a sixth of a capital letter
  Rgb color_;
};

}  // namespace pointsweep
