// SPDX-License-Identifier: MIT
/// Plots as inline SVG, without scripts and external files.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pointsweep {

/// A mark on the scale of a plot, at a round value.
struct Tick {
  double value;
  std::string text;
};

/// The scale of a plot, from values to places: a linear or logarithmic axis over [lo, hi], drawn from `begin` to `end`.
class Scale {
 public:
  /// Logarithmic: lo and hi must be positive. An empty range is widened.
  Scale(double lo, double hi, double begin, double end, bool logarithmic = false);

  double place(double value) const;
  /// About `wanted` of them at 1, 2 or 5 times a power of ten; powers of ten (with 2 and 5 where these are few) if
  /// logarithmic.
  std::vector<Tick> ticks(int wanted) const;

 private:
  double lo_, hi_, begin_, end_;
  bool logarithmic_;
};

/// Formats a number briefly, in engineering's thousands where that is shorter: "0", "12", "1.5k", "20M", "3.2e-05".
std::string short_number(double value);

struct PlotText {
  std::string title, x, y;  ///< labels of the axes with their units
};

struct Series {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< x ascending
};

/// Lines over linear axes from 0. Points that are not finite are left out.
std::string line_plot(const PlotText& text, const std::vector<Series>& series);

struct Bar {
  std::string name;
  double value;       ///< not negative
  std::string label;  ///< written after the bar
};
/// Returns horizontal bars, one below another.
std::string bar_plot(const std::string& title, const std::vector<Bar>& bars);

/// Counts in bins that touch each other.
struct Histogram {
  std::string name;
  std::vector<double> counts;
};
/// Outlines over a logarithmic x axis: bin i is edges[i] .. edges[i+1], all positive.
std::string histogram_plot(const PlotText& text, const std::vector<double>& edges,
                           const std::vector<Histogram>& histograms);

/// Small bars that touch each other over a linear x axis: bin i is edges[i] .. edges[i+1].
std::string value_plot(const std::string& title, const std::vector<double>& edges, const std::vector<double>& counts);

/// & < > " as entities.
std::string escaped(std::string_view text);

}  // namespace pointsweep
