// SPDX-License-Identifier: MIT
#include "pointsweep/render/point_shape.h"

#include <algorithm>
#include <cmath>

namespace pointsweep {
namespace {

/// Radius of discs in spacings. Discs of 1.5 spacings on a surface with random points leave about 0.1 % of it uncovered
/// (exp(-π r²)). For points without a normal, which may be leaves or walls, discs wider than one spacing look like
/// bubbles.
constexpr double kSurfaceRadius = 1.5, kPointRadius = 1;

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
