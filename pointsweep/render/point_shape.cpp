// SPDX-License-Identifier: MIT
#include "pointsweep/render/point_shape.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "pointsweep/free_memory.h"
#include "pointsweep/math/box.h"

namespace pointsweep {
namespace {

constexpr std::size_t kLeaf = 16;  ///< most points of a leaf of a SpacingTree, unless all are at one place
/// Radius of discs in spacings. Discs of 1.5 spacings on a surface with random points leave about 0.1 % of it uncovered
/// (exp(-π r²)). For points without a normal, which may be leaves or walls, discs wider than one spacing look like
/// bubbles.
constexpr double kSurfaceRadius = 1.5, kPointRadius = 1;

/// Returns the product of the two longer sides of the box. For `points` points on a line, returns the area of a strip
/// as wide as their spacing.
double area_of(const Box& box, std::size_t points) {
  const Vec3 e = box.extent();
  const double longest = std::max({e.x, e.y, e.z}), shortest = std::min({e.x, e.y, e.z});
  const double middle = e.x + e.y + e.z - longest - shortest;
  return longest * std::max(middle, longest / static_cast<double>(points));
}

/// Returns twice the 75 % quantile of the distances to the nearest point at another place. For random points on a
/// surface this is 1.3 times the side of the square per point; for widely spaced rows of a scanner it is twice the step
/// along a row.
double twice_nearest(std::span<const Vec3> points) {
  std::vector<double> nearest2(points.size(), Box::kInf);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < points.size(); ++j)
      if (points[i] != points[j]) nearest2[i] = std::min(nearest2[i], distance2(points[i], points[j]));
  const auto usual = nearest2.begin() + static_cast<std::ptrdiff_t>(nearest2.size() * 3 / 4);
  std::nth_element(nearest2.begin(), usual, nearest2.end());
  return 2 * std::sqrt(*usual);
}

Vec3 unit_or_zero(Vec3 v) {
  const double l = length(v);
  return std::isfinite(l) && l > 0 ? (1 / l) * v : Vec3{};
}

/// Returns a unit vector perpendicular to `n`.
Vec3 across(Vec3 n) {
  const Vec3 axis = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  return unit_or_zero(cross(n, axis));
}

}  // namespace

SpacingTree::SpacingTree(std::vector<Vec3> sample, std::uint64_t points) : sample_(std::move(sample)) {
  const double share = points == 0 ? 1 : static_cast<double>(sample_.size()) / static_cast<double>(points);
  build(0, sample_.size(), std::min(share, 1.0));
  free_memory_of(sample_);
}

void SpacingTree::build(std::size_t begin, std::size_t end, double share) {
  Box box;
  for (std::size_t i = begin; i < end; ++i) box.include(sample_[i]);
  const std::size_t count = end - begin, node = nodes_.size();
  nodes_.emplace_back();
  const int axis = box.longest_axis();
  if (count <= kLeaf || box.extent()[axis] <= 0) {
    // n points in a row have n - 1 gaps. Along a side of sqrt(n) points, half a gap is subtracted; this matters for few
    // points.
    const double gaps = std::sqrt(static_cast<double>(std::max<std::size_t>(count, 1))) - 0.5;
    if (count > 1 && count <= kLeaf) {
      const double side = std::sqrt(area_of(box, count)) / gaps;
      nodes_[node].spacing = std::sqrt(share) * std::min(side, twice_nearest({sample_.data() + begin, count}));
    }
    return;
  }
  const std::size_t middle = begin + count / 2;
  const auto at = [this](std::size_t i) { return sample_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [axis](Vec3 a, Vec3 b) { return a[axis] < b[axis]; });
  nodes_[node].axis = axis;
  nodes_[node].split = sample_[middle][axis];
  build(begin, middle, share);
  nodes_[node].above = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end, share);
}

double SpacingTree::spacing(Vec3 p) const {
  std::uint32_t node = 0;
  while (nodes_[node].axis >= 0) {
    const Node& n = nodes_[node];
    node = p[n.axis] < n.split ? node + 1 : n.above;
  }
  return nodes_[node].spacing;
}

PointShape::Fields::Fields(const Schema& schema, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    const auto field = schema.find(name);
    if (!field) {
      clear();
      return;
    }
    push_back(schema.fields[*field]);
  }
}

PointShape::PointShape(const Schema& schema, const SpacingTree& spacing, Vec3 right, Vec3 up, DiscRadii radii)
    : spacing_(spacing),
      right_(right),
      up_(up),
      radii_(radii),
      normal_(schema, {"nx", "ny", "nz"}),
      axis_(schema, {"splat_x", "splat_y", "splat_z"}),
      size_(schema, {"splat_length", "splat_ratio"}),
      radius_(schema, {"radius"}) {}

Vec3 PointShape::vector_of(const Fields& fields, const std::byte* record) {
  return {value_of(fields[0], record), value_of(fields[1], record), value_of(fields[2], record)};
}

SurfaceElement PointShape::operator()(const std::byte* record, Vec3 position) const {
  const Vec3 n = normal_.empty() ? Vec3{} : unit_or_zero(vector_of(normal_, record));
  const bool has_normal = n != Vec3{};
  if (radii_.fixed > 0) return {radii_.fixed * right_, radii_.fixed * up_, n};
  if (has_normal && !axis_.empty() && !size_.empty()) {
    const Vec3 axis = unit_or_zero(vector_of(axis_, record));
    const double major = value_of(size_[0], record), minor = major * value_of(size_[1], record);
    if (axis != Vec3{} && major > 0 && std::isfinite(major) && minor > 0 && std::isfinite(minor)) {
      return {major * axis, minor * cross(n, axis), n};
    }
  }
  const double stated = radius_.empty() ? 0 : value_of(radius_[0], record);
  const double radius =
      stated > 0 && std::isfinite(stated)
          ? stated
          : std::min((has_normal ? kSurfaceRadius : kPointRadius) * spacing_.spacing(position), radii_.largest_guess);
  if (!has_normal) return {radius * right_, radius * up_, {}};
  const Vec3 u = across(n);
  return {radius * u, radius * cross(n, u), n};
}

}  // namespace pointsweep
