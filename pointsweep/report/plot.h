// SPDX-License-Identifier: MIT
/// Plots as inline SVG, without scripts or files beside them.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pointsweep {

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
/// Horizontal bars, one below the other.
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
