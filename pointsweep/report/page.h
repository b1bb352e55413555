// SPDX-License-Identifier: MIT
/// An HTML page in one file, which contains its plots and pictures and loads nothing else. Plots are inline SVG without
/// scripts.
#pragma once

#include <cstddef>
#include <span>
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

/// The scale of an axis: maps the values [lo, hi], linearly or logarithmically, to the coordinates from `begin` to
/// `end` of an SVG.
class Scale {
 public:
  /// Makes a scale. On a logarithmic scale, `lo` and `hi` must be positive. An empty range is widened.
  Scale(double lo, double hi, double begin, double end, bool logarithmic = false);

  double place(double value) const;
  /// Returns about `wanted` ticks at the multiples of a step, which is 1, 2 or 5 times a power of ten. On a logarithmic
  /// scale they are powers of ten, or every n-th power; below 2.5 decades, also 2 and 5 times the powers.
  std::vector<Tick> ticks(int wanted) const;

 private:
  double lo_, hi_, begin_, end_;
  bool logarithmic_;
};

/// Formats a number briefly, with the suffix k, M or G from 1,000 on, and as a power of ten from 1e12 on and below
/// 0.001: "0", "12", "1.5k", "20M", "3.2e-05".
std::string short_number(double value);

struct PlotText {
  std::string title, x, y;  ///< title of the plot, labels of the axes with their units
};

struct Series {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< x and y of each point, ascending by x
};

/// Returns a plot of lines over linear axes that begin at 0. Points that are not finite are left out.
std::string line_plot(const PlotText& text, const std::vector<Series>& series);

struct Bar {
  std::string name;
  double value;       ///< length of the bar, not negative
  std::string label;  ///< text after the bar
};
/// Returns a plot of horizontal bars, one below another.
std::string bar_plot(const std::string& title, const std::vector<Bar>& bars);

/// A named histogram: a count for each of successive bins.
struct Histogram {
  std::string name;
  std::vector<double> counts;
};
/// Returns a plot of the outlines of histograms over a logarithmic x axis. Bin i is edges[i] .. edges[i+1]; all edges
/// are positive. Empty for fewer than two edges.
std::string histogram_plot(const PlotText& text, const std::vector<double>& edges,
                           const std::vector<Histogram>& histograms);

/// Returns a small plot of adjacent bars over a linear x axis. Bin i is edges[i] .. edges[i+1]. Empty without counts.
std::string value_plot(const std::string& title, const std::vector<double>& edges, const std::vector<double>& counts);

/// Returns the text with & < > " as HTML entities.
std::string escaped(std::string_view text);

/// Returns the bytes in Base64 (RFC 4648), with padding.
std::string to_base64(std::span<const std::byte> bytes);

class Page {
 public:
  explicit Page(std::string title) : title_(std::move(title)) {}

  void heading(const std::string& text);
  void paragraph(const std::string& text);
  /// Adds a table with two columns of text.
  void table(const std::vector<std::pair<std::string, std::string>>& rows);
  /// Adds a plot, an SVG that line_plot() or another function above returns; nothing if it is empty.
  void plot(const std::string& svg);
  /// Adds a plot with a caption below it. Successive figures stand side by side if the page is wide enough.
  void figure(const std::string& svg, const std::string& caption);
  void picture(std::span<const std::byte> png, const std::string& caption);

  std::string html() const;

 private:
  std::string title_, body_;
};

}  // namespace pointsweep
