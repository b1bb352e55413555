// SPDX-License-Identifier: MIT
#include "pointsweep/render/view.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "pointsweep/fail.h"

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

/// Turns a vector from the frame with z up to a frame where another direction is up; all right-handed.
Vec3 with_up(Vec3 v, Up up) {
  if (up.sign < 0) v = {v.x, -v.y, -v.z};
  if (up.axis == 1) return {v.x, v.z, -v.y};
  if (up.axis == 0) return {v.z, v.x, v.y};
  return v;
}

bool parse_number(std::string_view text, double& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
}

}  // namespace

std::optional<Angles> parse_view(std::string_view text) {
  if (text == "auto") return std::nullopt;
  if (text == "front") return Angles{0, 0};
  if (text == "top") return kTop;
  if (text == "iso") return Angles{45, 35.264389682754654};
  Angles angles;
  const std::size_t comma = text.find(',');
  if (comma == text.npos || !parse_number(text.substr(0, comma), angles.azimuth) ||
      !parse_number(text.substr(comma + 1), angles.elevation) || std::abs(angles.elevation) > 90 ||
      std::abs(angles.azimuth) > 1e6) {
    fail_usage(
        "--view: '{}' is not auto, front, top, iso or AZIMUTH,ELEVATION in degrees with an elevation of -90 to 90, "
        "e.g. 30,20.",
        text);
  }
  return angles;
}

std::optional<Up> parse_up(std::string_view text) {
  if (text == "auto") return std::nullopt;
  std::string_view axis = text;
  const int sign = axis.starts_with('-') ? -1 : 1;
  if (sign < 0) axis.remove_prefix(1);
  if (axis != "x" && axis != "y" && axis != "z") fail_usage("--up: '{}' is not auto, x, y, z, -x, -y or -z.", text);
  return Up{axis[0] - 'x', sign};
}

Camera camera_of(const View& view, Vec3 origin, unsigned width, unsigned height) {
  const double sa = sine(view.angles.azimuth), ca = cosine(view.angles.azimuth);
  const double se = sine(view.angles.elevation), ce = cosine(view.angles.elevation);
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

void frame(Camera& camera, double lo_x, double hi_x, double lo_y, double hi_y, double margin) {
  camera.center_x = 0.5 * (lo_x + hi_x);
  camera.center_y = 0.5 * (lo_y + hi_y);
  const auto room = [&](double side) { return side - 2 * std::clamp(margin, kMargin * side, 0.4 * side); };
  const double across = hi_x > lo_x ? room(camera.width) / (hi_x - lo_x) : Box::kInf;
  const double along = hi_y > lo_y ? room(camera.height) / (hi_y - lo_y) : Box::kInf;
  const double scale = std::min(across, along);
  camera.scale = std::isfinite(scale) ? scale : 1;
}

}  // namespace pointsweep
