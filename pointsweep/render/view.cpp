// SPDX-License-Identifier: MIT
#include "pointsweep/render/view.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "pointsweep/error.h"

namespace pointsweep {
namespace {

constexpr double kMargin = 0.03;

/// The Taylor series, for any angle: 3e-16 near 0, 1e-13 at 180 degrees.
double sine(double degrees) {
  const double x = (degrees - 360 * std::floor(degrees / 360 + 0.5)) * (std::numbers::pi / 180);
  double term = x, sum = x;
  for (int i = 2; i < 40; i += 2) {
    term *= -x * x / (i * (i + 1));
    sum += term;
  }
  return sum;
}
double cosine(double degrees) { return sine(degrees + 90); }

/// From the frame with z up to one where another axis is up; both right-handed.
Vec3 with_up(Vec3 v, int up) {
  if (up == 1) return {v.x, v.z, -v.y};
  if (up == 0) return {v.z, v.x, v.y};
  return v;
}

bool parse_number(std::string_view text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

}  // namespace

View parse_view(std::string_view text, int up) {
  if (text == "front") return {0, 0, up};
  if (text == "top") return {0, 90, up};
  if (text == "iso") return {45, 35.264389682754654, up};
  View view{0, 0, up};
  const std::size_t comma = text.find(',');
  if (comma == text.npos || !parse_number(text.substr(0, comma), view.azimuth) ||
      !parse_number(text.substr(comma + 1), view.elevation) || std::abs(view.elevation) > 90 ||
      std::abs(view.azimuth) > 1e6) {
    fail_usage(
        "--view: '{}' is not front, top, iso or AZIMUTH,ELEVATION in degrees with an elevation of -90 to 90, e.g. "
        "30,20.",
        text);
  }
  return view;
}

Camera camera_of(const View& view, Vec3 origin, unsigned width, unsigned height) {
  const double sa = sine(view.azimuth), ca = cosine(view.azimuth);
  const double se = sine(view.elevation), ce = cosine(view.elevation);
  const Vec3 toward{sa * ce, -ca * ce, se}, right{ca, sa, 0};
  Camera camera;
  camera.toward = with_up(toward, view.up);
  camera.right = with_up(right, view.up);
  camera.up = with_up(cross(toward, right), view.up);
  camera.origin = origin;
  camera.width = width;
  camera.height = height;
  return camera;
}

void frame(Camera& camera, double lo_x, double hi_x, double lo_y, double hi_y) {
  camera.center_x = 0.5 * (lo_x + hi_x);
  camera.center_y = 0.5 * (lo_y + hi_y);
  const double room = 1 - 2 * kMargin;
  const double across = hi_x > lo_x ? room * camera.width / (hi_x - lo_x) : Box::kInf;
  const double along = hi_y > lo_y ? room * camera.height / (hi_y - lo_y) : Box::kInf;
  const double scale = std::min(across, along);
  camera.scale = std::isfinite(scale) ? scale : 1;
}

}  // namespace pointsweep
