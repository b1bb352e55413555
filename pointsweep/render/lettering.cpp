// SPDX-License-Identifier: MIT
#include "pointsweep/render/lettering.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace pointsweep {
namespace {

/// The characters from ' ' to '~'. Each is some polylines, separated by blanks; each vertex is two digits, x and y. The
/// baseline is y = 2, small letters reach 6, capitals 8.
constexpr std::array<const char*, 95> kStrokes = {
    "", "0804 0202", "0806 2826", "1318 3338 0444 0747", "473818070615354443321203 2921", "0248 0708181707 3233434232",
    "4216172837360403122244", "0806", "19070311", "09171301", "1713 0624 0426", "2327 0545", "1201", "0535", "0202",
    "0139",
    // 0 to 9
    "120307183847433212", "072822", "07183847460242", "07183847463515 354443321203", "32380444", "48080516364543321203",
    "473818070312324344351504", "084812", "15060718384746351504031232434435", "031232434738180706153546",
    // : to @
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
constexpr double kHalfStroke = 0.42, kGap = 1.7, kBlank = 3.2;  // units

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

void blend(Rgb& pixel, Rgb color, double share) {
  const auto mix = [share](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(a + (static_cast<double>(b) - a) * share + 0.5);
  };
  pixel = {mix(pixel.red, color.red), mix(pixel.green, color.green), mix(pixel.blue, color.blue)};
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
        if (share > 0) blend(picture.pixels[std::size_t{row} * picture.width + column], color_, share);
      }
    }
    left += unit_ * advance_of(c);
  }
}

}  // namespace pointsweep
