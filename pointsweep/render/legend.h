// SPDX-License-Identifier: MIT
/// The legend that explains the colours of a picture, at its right edge.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/render/canvas.h"
#include "pointsweep/render/lettering.h"

namespace pointsweep {

/// A bar of colours with numbers beside it, or a list of colours with names.
struct Legend {
  std::string title;  ///< e.g. "rms_curvature"
  std::string unit;   ///< e.g. "1/m"; may be empty
  bool is_bar = false;
  double lo = 0, hi = 1;                             ///< ends of the bar
  std::vector<std::pair<Rgb, std::string>> entries;  ///< entries of the list

  bool empty() const { return !is_bar && entries.empty(); }
};

/// Lays a legend out for a picture of that size.
class LegendColumn {
 public:
  LegendColumn(Legend legend, unsigned width, unsigned height, Rgb background);

  /// Pixels at the right edge that the legend takes; 0 if there is none, or if it would take more than a third of the
  /// picture.
  unsigned width() const { return width_; }
  /// Fills the column and draws the legend into it.
  void draw(Picture& picture) const;

 private:
  void draw_bar(Picture& picture, double left) const;
  void draw_list(Picture& picture, double left) const;
  std::vector<std::string> labels() const;

  Legend legend_;
  Rgb background_;
  Lettering lettering_;
  unsigned width_ = 0;
};

}  // namespace pointsweep
