// SPDX-License-Identifier: MIT
#include "pointsweep/render/legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pointsweep/colors/color_map.h"

namespace pointsweep {

namespace {

template <std::size_t N>
bool is_one_of(const std::array<std::string_view, N>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

constexpr int kMarks = 5;  // numbers beside a bar, both ends included
constexpr const char* kRange = "5 % to 95 % of points";

Rgb ink_on(Rgb background) {
  const int light = 2 * background.red + 5 * background.green + background.blue;
  return light > 8 * 110 ? Rgb{40, 44, 52} : Rgb{225, 228, 232};
}

void fill(Picture& picture, double x0, double y0, double x1, double y1, Rgb color) {
  const auto pixel = [](double v, unsigned count) {
    return static_cast<unsigned>(std::clamp(v + 0.5, 0.0, static_cast<double>(count)));
  };
  for (unsigned y = pixel(y0, picture.height); y < pixel(y1, picture.height); ++y)
    for (unsigned x = pixel(x0, picture.width); x < pixel(x1, picture.width); ++x)
      picture.pixels[std::size_t{y} * picture.width + x] = color;
}

/// `value` with as many digits as tell the marks of a bar apart.
std::string mark_text(double value, double step) {
  const double largest = std::abs(value) + step;
  if (!(step > 0) || !(largest < 1e9) || step < 1e-5) return fmt::format("{:.4g}", value);
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(step))), 0, 7);
  return fmt::format("{:.{}f}", value, decimals);
}

}  // namespace

std::string unit_of_attribute(std::string_view name, std::string_view length) {
  constexpr std::array<std::string_view, 7> kLengths = {"height",          "x",     "y", "z", "splat_length",
                                                        "neighbor_radius", "radius"};
  constexpr std::array<std::string_view, 5> kCurvatures = {"k1", "k2", "mean_curvature", "rms_curvature",
                                                           "absolute_curvature"};
  if (is_one_of(kLengths, name) || name.starts_with("distance_"))
    return length.empty() ? "file units" : std::string(length);
  const std::string unit(length.empty() ? "file unit" : length);
  if (is_one_of(kCurvatures, name)) return "1/" + unit;
  if (name == "gaussian_curvature") return "1/" + unit + "^2";
  if (name == "gps_time") return "s";
  if (name == "scan_angle") return "degrees";
  return {};
}

LegendColumn::LegendColumn(Legend legend, unsigned width, unsigned height, Rgb background)
    : legend_(std::move(legend)),
      background_(background),
      lettering_(std::clamp(height / 75.0, 7.0, 48.0), ink_on(background)) {
  if (legend_.empty()) return;
  double widest = lettering_.width(legend_.title);
  const double beside = 2.2 * lettering_.line_height();
  for (const std::string& label : labels()) widest = std::max(widest, beside + lettering_.width(label));
  if (legend_.is_bar) widest = std::max(widest, lettering_.width(kRange));
  const double wanted = widest + 2 * lettering_.line_height();
  if (wanted <= width / 3.0 && height >= 10 * lettering_.line_height()) width_ = static_cast<unsigned>(wanted);
}

std::vector<std::string> LegendColumn::labels() const {
  std::vector<std::string> texts;
  for (const auto& [color, name] : legend_.entries) texts.push_back(name);
  if (!legend_.is_bar) return texts;
  const double step = (legend_.hi - legend_.lo) / (kMarks - 1);
  if (!(step > 0)) return {mark_text(legend_.lo, 0)};
  for (int i = 0; i < kMarks; ++i) texts.push_back(mark_text(legend_.lo + i * step, step));
  return texts;
}

void LegendColumn::draw(Picture& picture) const {
  if (width_ == 0) return;
  const double line = lettering_.line_height(), edge = picture.width - width_;
  fill(picture, edge, 0, picture.width, picture.height, background_);
  const double left = edge + line;
  lettering_.draw(picture, left, 2 * line, legend_.title);
  if (!legend_.unit.empty()) lettering_.draw(picture, left, 3 * line, "in " + legend_.unit);
  legend_.is_bar ? draw_bar(picture, left) : draw_list(picture, left);
}

void LegendColumn::draw_bar(Picture& picture, double left) const {
  const double line = lettering_.line_height(), top = 4.2 * line, bottom = picture.height - 3 * line;
  const std::vector<std::string> texts = labels();
  for (double y = std::floor(top); y < bottom; y += 1) {
    const double place = texts.size() == 1 ? 0 : (bottom - y - 0.5) / (bottom - top);
    fill(picture, left, y, left + 1.3 * line, y + 1, viridis(place));
  }
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const double share = texts.size() == 1 ? 0.5 : static_cast<double>(i) / static_cast<double>(texts.size() - 1);
    const double y = bottom - share * (bottom - top);
    lettering_.draw(picture, left + 1.8 * line, y + 0.5 * lettering_.capital(), texts[i]);
  }
  lettering_.draw(picture, left, picture.height - line, kRange);
}

void LegendColumn::draw_list(Picture& picture, double left) const {
  const double line = 1.3 * lettering_.line_height(), box = lettering_.capital();
  double baseline = 3.2 * lettering_.line_height();
  for (const auto& [color, name] : legend_.entries) {
    if (baseline > picture.height - line) break;
    fill(picture, left, baseline - box, left + 1.5 * box, baseline, color);
    lettering_.draw(picture, left + 2.3 * box, baseline, name);
    baseline += line;
  }
}

}  // namespace pointsweep
