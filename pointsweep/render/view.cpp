// SPDX-License-Identifier: MIT
#include "pointsweep/render/view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "pointsweep/fail.h"
#include "pointsweep/number_from.h"

namespace pointsweep {
namespace {

constexpr double kMargin = 0.03;

/// Returns the sine of any angle by the Taylor series, with an error of 3e-16 near 0 and 1e-13 at 180 degrees.
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

/// Converts a vector from the coordinate frame with z up to the frame with `up` as its direction up. Both frames are
/// right-handed.
Vec3 with_up(Vec3 v, Up up) {
  if (up.sign < 0) v = {v.x, -v.y, -v.z};
  if (up.axis == 1) return {v.x, v.z, -v.y};
  if (up.axis == 0) return {v.z, v.x, v.y};
  return v;
}

constexpr double kOutliers = 0.001;  // share of the points beyond either end of the extents
constexpr double kFlatness = 0.25;
constexpr double kFootHeight = 0.02;  // height of the lowest layer of points, as a share of the extent
constexpr double kPreferenceForZ = 1.25, kLeastFooting = 0.25;

struct Range {
  double lo = 0, hi = 0;
  double extent() const { return hi - lo; }
};

Range range_along(std::span<const Vec3> sample, int axis) {
  std::vector<double> values;
  values.reserve(sample.size());
  for (const Vec3 p : sample) values.push_back(p[axis]);
  std::sort(values.begin(), values.end());
  if (values.empty()) return {};
  const auto cut = static_cast<std::size_t>(kOutliers * static_cast<double>(values.size()));
  return {values[cut], values[values.size() - 1 - cut]};
}

std::array<Range, 3> ranges_of(std::span<const Vec3> sample) {
  return {range_along(sample, 0), range_along(sample, 1), range_along(sample, 2)};
}

std::pair<int, int> axes_across(int axis) { return {(axis + 1) % 3, (axis + 2) % 3}; }

bool is_flat(const std::array<Range, 3>& ranges, int axis) {
  const auto extent = [&](int a) { return ranges[a].extent(); };
  const auto [a, b] = axes_across(axis);
  const double across = std::sqrt(extent(a) * extent(b));
  return across > 0 && extent(axis) <= kFlatness * across;
}

using Point2 = std::pair<double, double>;

/// Returns twice the area of the triangle a, b, c; positive if the path a, b, c turns to the left.
double turn(Point2 a, Point2 b, Point2 c) {
  return (b.first - a.first) * (c.second - a.second) - (b.second - a.second) * (c.first - a.first);
}

/// Returns the area of the convex hull of the points (monotone chain, Andrew 1979).
double hull_area(std::vector<Point2> points) {
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return 0;
  std::vector<Point2> hull;
  const auto add = [&hull](Point2 p, std::size_t kept) {
    while (hull.size() >= kept + 2 && turn(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
    hull.push_back(p);
  };
  for (const Point2& p : points) add(p, 0);
  const std::size_t lower = hull.size() - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;) add(points[i], lower);
  double area = 0;
  for (std::size_t i = 1; i + 1 < hull.size(); ++i) area += turn(hull[0], hull[i], hull[i + 1]);
  return 0.5 * area;
}

/// Returns the share of the side below `up` that the lowest points cover, in [0, 1].
double footing(std::span<const Vec3> sample, const std::array<Range, 3>& ranges, Up up) {
  const auto [a, b] = axes_across(up.axis);
  const Range across_a = ranges[a], across_b = ranges[b];
  const Range along = ranges[up.axis];
  const double bottom = up.sign > 0 ? along.lo : -along.hi, top = bottom + kFootHeight * along.extent();
  std::vector<Point2> feet;
  for (const Vec3 p : sample) {
    const double height = up.height(p);
    if (height < bottom || height > top) continue;
    feet.emplace_back(std::clamp(p[a], across_a.lo, across_a.hi), std::clamp(p[b], across_b.lo, across_b.hi));
  }
  const double side = across_a.extent() * across_b.extent();
  return side > 0 ? hull_area(std::move(feet)) / side : 0;
}

}  // namespace

std::optional<Angles> parse_view(std::string_view text) {
  if (text == "auto") return std::nullopt;
  if (text == "front") return Angles{0, 0};
  if (text == "top") return kTop;
  if (text == "iso") return Angles{45, 35.264389682754654};
  const std::size_t comma = std::min(text.find(','), text.size());
  const auto azimuth = number_from<double>(text.substr(0, comma));
  const auto elevation = number_from<double>(text.substr(std::min(comma + 1, text.size())));
  if (!azimuth || !elevation || !(std::abs(*elevation) <= 90) || !(std::abs(*azimuth) <= 1e6)) {
    fail_usage(
        "--view: '{}' is not auto, front, top, iso or AZIMUTH,ELEVATION in degrees with an elevation of -90 to 90, "
        "e.g. 30,20.",
        text);
  }
  return Angles{*azimuth, *elevation};
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

bool is_flat(std::span<const Vec3> sample, Up up) { return is_flat(ranges_of(sample), up.axis); }

Up find_up(std::span<const Vec3> sample) {
  const std::array<Range, 3> ranges = ranges_of(sample);
  int thinnest = 2;
  for (const int axis : {1, 0}) {
    if (ranges[axis].extent() < ranges[thinnest].extent()) thinnest = axis;
  }
  if (is_flat(ranges, thinnest)) return {thinnest, 1};
  Up best;
  double most = std::max(kLeastFooting, kPreferenceForZ * footing(sample, ranges, best));
  for (const Up up : {Up{1, 1}, Up{0, 1}, Up{2, -1}, Up{1, -1}, Up{0, -1}}) {
    const double here = footing(sample, ranges, up);
    if (here > most) most = here, best = up;
  }
  return best;
}

}  // namespace pointsweep
