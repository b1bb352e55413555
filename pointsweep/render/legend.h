// SPDX-License-Identifier: MIT
/// The legend that explains the colours of a picture, at its right edge. Its text consists of strokes, scalable and
/// with smooth edges.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/render/canvas.h"

namespace pointsweep {

/// Draws text of printable ASCII; any other byte is drawn as '?'.
class Lettering {
 public:
  /// `capital` is the height of a capital letter in pixels.
  Lettering(double capital, Rgb color) : unit_(capital / 6), color_(color) {}

  /// Returns the distance in pixels from the left edge of the first letter to the right edge of the last.
  double width(std::string_view text) const;
  /// Returns the distance in pixels from one baseline to the next.
  double line_height() const { return 11 * unit_; }
  double capital() const { return 6 * unit_; }

  /// Draws the text with its left end at `x` and its baseline at `baseline`, in pixels from the upper left corner.
  /// Parts outside of the picture are cut off.
  void draw(Picture& picture, double x, double baseline, std::string_view text) const;

 private:
  double unit_;  ///< a sixth of the height of a capital letter, in pixels
  Rgb color_;
};

/// Returns the unit of the attribute with this name: "1/m" for a curvature, "s" for gps_time, empty if the attribute
/// has no unit or the unit is unknown. `length` is the unit of the cloud's coordinates, e.g. "m"; if it is empty, "file
/// unit" or "file units" stands for it.
std::string unit_of_attribute(std::string_view name, std::string_view length);

/// A bar of colours with numbers, or a list of colours with names.
struct Legend {
  std::string title;  ///< e.g. "rms_curvature"
  std::string unit;   ///< unit of the numbers, e.g. "1/m"; empty without a known unit
  bool is_bar = false;
  double lo = 0, hi = 1;                             ///< ends of the bar
  std::vector<std::pair<Rgb, std::string>> entries;  ///< entries of the list

  bool empty() const { return !is_bar && entries.empty(); }
};

/// The layout of a legend for a picture of a given size.
class LegendColumn {
 public:
  LegendColumn(Legend legend, unsigned width, unsigned height, Rgb background);

  /// Returns the number of pixel columns of the legend, at the right edge of the picture; 0 if the legend is empty,
  /// would take more than a third of the picture's width, or if the picture is less than 10 lines of text high.
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
