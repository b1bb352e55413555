// SPDX-License-Identifier: MIT
#include "pointsweep/render/point_shape.h"

#include <algorithm>
#include <cmath>

namespace pointsweep {
namespace {

/// Discs of this many spacings leave about 0.1 % of a surface bare where points lie at random (exp(-π r²)).
constexpr double kRadiusInSpacings = 1.5;

Vec3 unit_or_zero(Vec3 v) {
  const double l = length(v);
  return std::isfinite(l) && l > 0 ? (1 / l) * v : Vec3{};
}

/// Some unit vector across `n`.
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

PointShape::PointShape(const Schema& schema, const SpacingTree& spacing, Vec3 right, Vec3 up, double largest_guess)
    : spacing_(spacing),
      right_(right),
      up_(up),
      largest_guess_(largest_guess),
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
  if (has_normal && !axis_.empty() && !size_.empty()) {
    const Vec3 axis = unit_or_zero(vector_of(axis_, record));
    const double major = value_of(size_[0], record), minor = major * value_of(size_[1], record);
    if (axis != Vec3{} && major > 0 && std::isfinite(major) && minor > 0 && std::isfinite(minor)) {
      return {major * axis, minor * cross(n, axis), n};
    }
  }
  const double stated = radius_.empty() ? 0 : value_of(radius_[0], record);
  const double radius = stated > 0 && std::isfinite(stated)
                            ? stated
                            : std::min(kRadiusInSpacings * spacing_.spacing(position), largest_guess_);
  if (!has_normal) return {radius * right_, radius * up_, {}};
  const Vec3 u = across(n);
  return {radius * u, radius * cross(n, u), n};
}

}  // namespace pointsweep
