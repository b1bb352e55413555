// SPDX-License-Identifier: MIT
#include "pointsweep/render/legend.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pointsweep/colors/color_map.h"

namespace pointsweep {
namespace {

/// The strokes of the characters from ' ' to '~'. A character consists of polylines, separated by blanks. Each vertex
/// of a polyline is two digits, x and y. The baseline is y = 2. Capitals and ascenders reach y = 8, other small letters
/// y = 6, and descenders y = 0.
constexpr std::array<const char*, 95> kStrokes = {
    "", "0804 0202", "0806 2826", "1318 3338 0444 0747", "473818070615354443321203 2921", "0248 0708181707 3233434232",
    "4216172837360403122244", "0806", "19070311", "09171301", "1713 0624 0426", "2327 0545", "1201", "0535", "0202",
    "0139",
    // 0 to 9
    "120307183847433212", "072822", "07183847460242", "07183847463515 354443321203", "32380444", "48080516364543321203",
    "473818070312324344351504", "084812", "15060718384746351504031232434435", "031232434738180706153546",
    // from : to @
    "0202 0505", "1201 1515", "370533", "0444 0646", "073503", "07183847462524 2222", "4212030718384744242646",
    // A to Z
    "022842 1434", "02083847463505 3544433202", "4738180703123243", "02083847433202", "48080242 0535", "480802 0535",
    "47381807031232434525", "0208 4248 0545", "1218 0828 0222", "3833221203", "0208 4804 1542", "080242", "0208254842",
    "02084248", "120307183847433212", "02083847463505", "120307183847433212 2442", "02083847463505 2542",
    "473818070615354443321203", "0848 2822", "080312324348", "082248", "0812263248", "0248 0842", "082548 2522",
    "08480242",
    // [ to `
    "19090111", "0931", "09191101", "061826", "0141", "0817",
    // a to z
    "3632 3526160503122233", "0802 0516263533221203", "3526160503122233", "3832 3526160503122233", "043435261605031232",
    "281712 0626", "36312010 3526160503122233", "0802 0516263532", "0602 0808", "161100 1818", "0802 3604 1532", "0802",
    "0602 05162522 25364542", "0602 0516263532", "120305162635332212", "0600 0516263533221203", "3630 3526160503122233",
    "0602 051626", "35261605142433221203", "181322 0626", "0603122233 3632", "062246", "0612253246", "0236 0632",
    "0622 4610", "06360232",
    // { to ~
    "29181605141221", "0901", "09181625141201", "04153445"};
constexpr double kHalfStroke = 0.42, kGap = 1.7, kBlank = 3.2;  // in the units of kStrokes

const char* strokes_of(char c) {
  const bool printable = c >= ' ' && c <= '~';
  return kStrokes[static_cast<std::size_t>((printable ? c : '?') - ' ')];
}

struct Segment {
  double ax, ay, bx, by;
};

std::vector<Segment> segments_of(const char* strokes) {
  std::vector<Segment> segments;
  const auto digit = [](char c) { return static_cast<double>(c - '0'); };
  const char* previous = nullptr;
  for (const char* at = strokes; *at != '\0';) {
    if (*at == ' ') {
      previous = nullptr;
      ++at;
      continue;
    }
    if (previous) segments.push_back({digit(previous[0]), digit(previous[1]), digit(at[0]), digit(at[1])});
    previous = at;
    at += 2;
  }
  return segments;
}

double advance_of(char c) {
  double right = -1;
  for (const Segment& s : segments_of(strokes_of(c))) right = std::max({right, s.ax, s.bx});
  return right < 0 ? kBlank : right + kGap;
}

double distance_to(const Segment& s, double x, double y) {
  const double dx = s.bx - s.ax, dy = s.by - s.ay, length2 = dx * dx + dy * dy;
  const double t = length2 > 0 ? std::clamp(((x - s.ax) * dx + (y - s.ay) * dy) / length2, 0.0, 1.0) : 0;
  const double ex = x - s.ax - t * dx, ey = y - s.ay - t * dy;
  return std::sqrt(ex * ex + ey * ey);
}

constexpr int kMarks = 5;  // number of marks beside a bar, including both ends
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

/// Formats `value` with enough digits to distinguish marks that are `step` apart; with 4 digits if `step` is not
/// positive or below 1e-5, or if the value is about 1e9 or more in magnitude.
std::string mark_text(double value, double step) {
  const double largest = std::abs(value) + step;
  if (!(step > 0) || !(largest < 1e9) || step < 1e-5) return fmt::format("{:.4g}", value);
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(step))), 0, 7);
  return fmt::format("{:.{}f}", value, decimals);
}

}  // namespace

double Lettering::width(std::string_view text) const {
  double units = 0;
  for (const char c : text) units += advance_of(c);
  return text.empty() ? 0 : unit_ * (units - kGap + 2 * kHalfStroke);
}

void Lettering::draw(Picture& picture, double x, double baseline, std::string_view text) const {
  double left = x + kHalfStroke * unit_;
  for (const char c : text) {
    const std::vector<Segment> segments = segments_of(strokes_of(c));
    const auto pixel_range = [](double lo, double hi, unsigned count) {
      return std::pair(static_cast<unsigned>(std::clamp(std::floor(lo), 0.0, static_cast<double>(count))),
                       static_cast<unsigned>(std::clamp(std::ceil(hi), 0.0, static_cast<double>(count))));
    };
    const auto [x0, x1] = pixel_range(left - unit_, left + 5 * unit_, picture.width);
    const auto [y0, y1] = pixel_range(baseline - 8 * unit_, baseline + 3 * unit_, picture.height);
    for (unsigned row = y0; row < y1; ++row) {
      for (unsigned column = x0; column < x1; ++column) {
        const double px = (column + 0.5 - left) / unit_, py = 2 + (baseline - row - 0.5) / unit_;
        double distance = 100;
        for (const Segment& s : segments) distance = std::min(distance, distance_to(s, px, py));
        const double share = std::clamp(0.5 + unit_ * (kHalfStroke - distance), 0.0, 1.0);
        if (share <= 0) continue;
        Rgb& pixel = picture.pixels[std::size_t{row} * picture.width + column];
        pixel = mixed(pixel, color_, share);
      }
    }
    left += unit_ * advance_of(c);
  }
}

std::string unit_of_attribute(std::string_view name, std::string_view length) {
  constexpr std::string_view kLengths[] = {"x",
                                           "y",
                                           "z",
                                           "radius",
                                           "height",
                                           "height_range",
                                           "splat_length",
                                           "neighbor_radius",
                                           "k_distance",
                                           "mean_distance",
                                           "cloud_distance",
                                           "segment_residual",
                                           "simplify_radius",
                                           "m3c2_distance",
                                           "m3c2_lod",
                                           "m3c2_spread1",
                                           "m3c2_spread2",
                                           "moment1_axis1",
                                           "moment1_axis2"};
  constexpr std::string_view kCurvatures[] = {"k1", "k2", "mean_curvature", "rms_curvature", "absolute_curvature"};
  const auto is_one_of = [name](const auto& names) { return std::ranges::find(names, name) != std::end(names); };
  if (is_one_of(kLengths) || name.starts_with("distance_")) return length.empty() ? "file units" : std::string(length);
  const std::string unit(length.empty() ? "file unit" : length);
  if (is_one_of(kCurvatures)) return "1/" + unit;
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
