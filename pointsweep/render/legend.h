// SPDX-License-Identifier: MIT
/// The legend that explains the colours of a picture, at its right edge.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/render/canvas.h"
#include "pointsweep/render/lettering.h"

namespace pointsweep {

/// Returns the unit of an attribute whose name says what it is: "1/m" for a curvature, "s" for gps_time, empty for what
/// has no unit or is not known. `length` is the unit of the cloud's coordinates, e.g. "m"; empty: not known, then "file
/// unit" stands for it.
std::string unit_of_attribute(std::string_view name, std::string_view length);

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
