// SPDX-License-Identifier: MIT
#include "pointsweep/operators/curvature.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "pointsweep/math/saturated_float.h"
#include "pointsweep/operators/tangent_plane.h"
#include "pointsweep/operators/weighted_neighborhood.h"

namespace pointsweep {
namespace {

/// Curvatures of scaled offsets: 1 / (length · scale).
struct Principal {
  double k1 = 0, k2 = 0;
  Vec3 direction;  // of k1; 0 where there is no result
};

/// Sums over the neighbours that have a normal.
struct Sums {
  Symmetric3 weighted_normals;  // |N_i| C_i of Equation 2
  Symmetric3 normals, positions;
  Vec3 position;
  double count = 0;

  Sums(const Neighborhoods& in, std::size_t i, const WeightedNeighborhood& near) {
    for (std::size_t j = 0; j < near.size(); ++j) {
      const Vec3 n = unit_or_zero(in.neighbor_value<Float3>(0, i, j));
      if (n == Vec3{}) continue;
      const Vec3 o = near.offset(j);
      add_outer_product(weighted_normals, near.theta(o), n);
      add_outer_product(normals, 1, n);
      add_outer_product(positions, 1, o);
      position = position + o;
      ++count;
    }
  }

  /// Of the positions along unit vectors, about their mean, times `count`.
  double covariance(Vec3 u, Vec3 v) const {
    return bilinear_form(positions, u, v) - dot(position, u) * dot(position, v) / count;
  }
  double variance(Vec3 v) const { return covariance(v, v); }
};

Principal principal_curvatures(Vec3 n, const Sums& sums, const WeightedNeighborhood& near) {
  if (n == Vec3{} || sums.count < 3) return {};
  const Eigen3 e = eigen_symmetric3(sums.normals);
  Vec3 along = tangent(n, e.vector[1], e.vector[0]);
  const Vec3 across = cross(n, along);
  const double p1 = sums.variance(along), p2 = sums.variance(across), p12 = sums.covariance(along, across);
  const double spread = p1 + p2, noise = sums.count * (near.rounding() * near.rounding());
  // The determinant over the trace is the smaller eigenvalue, to a factor of two: 0 for points on a line.
  if (!(p1 * p2 - p12 * p12 > (1e-12 * spread + noise) * spread)) return {};
  double k1 = std::sqrt(std::max(e.value[1], 0.0) / p1), k2 = std::sqrt(std::max(e.value[0], 0.0) / p2);
  if (k1 < k2) {
    std::swap(k1, k2);
    along = across;
  }
  return {k1, k2, along};
}

/// Of C_i, ascending.
Float3 normal_eigenvalues(const Sums& sums, const WeightedNeighborhood& near) {
  const Eigen3 e = eigen_symmetric3(sums.weighted_normals);
  const double share = near.nearest_theta() / static_cast<double>(near.size());
  const auto value = [&](std::size_t v) { return static_cast<float>(std::max(e.value[v], 0.0) * share); };
  return {value(0), value(1), value(2)};
}

float surface_variation(const WeightedNeighborhood& near) {
  const Eigen3 e = eigen_symmetric3(near.moments());
  const double sum = e.value[0] + e.value[1] + e.value[2];
  return sum > 0 ? static_cast<float>(std::max(e.value[0], 0.0) / sum) : 0.0f;
}

}  // namespace

Attribute k1_attribute() { return scalar("k1", Type::f32, "1/length", "larger principal curvature, without sign"); }
Attribute k2_attribute() { return scalar("k2", Type::f32, "1/length", "smaller principal curvature, without sign"); }
Attribute k1_direction_attribute() {
  return {"k1_direction", Type::f32, Kind::vector, {"k1_x", "k1_y", "k1_z"}, "1", "unit tangent along which k1 is"};
}

Contract Curvature::contract() const {
  return {{normal_attribute()},
          {normal_attribute()},
          {k1_attribute(),
           k2_attribute(),
           k1_direction_attribute(),
           scalar("mean_curvature", Type::f32, "1/length", "(k1 + k2) / 2, without sign"),
           scalar("gaussian_curvature", Type::f32, "1/length^2", "k1 k2, without sign"),
           scalar("rms_curvature", Type::f32, "1/length", "square root of (k1^2 + k2^2) / 2"),
           scalar("absolute_curvature", Type::f32, "1/length", "k1 + k2"),
           scalar("surface_variation", Type::f32, "1", "smallest eigenvalue of M_i over the sum of all, [0, 1/3]"),
           {"normal_eigenvalues",
            Type::f32,
            Kind::scalar,
            {"normal_eigenvalue_0", "normal_eigenvalue_1", "normal_eigenvalue_2"},
            "1",
            "eigenvalues of C_i, ascending"}}};
}

void Curvature::apply(const Neighborhoods& in, Columns& out) const {
  const std::span<float> k1 = out.column<float>(0), k2 = out.column<float>(1);
  const std::span<Float3> direction = out.column<Float3>(2);
  const std::span<float> mean = out.column<float>(3), gaussian = out.column<float>(4), rms = out.column<float>(5),
                         absolute = out.column<float>(6), variation = out.column<float>(7);
  const std::span<Float3> eigenvalues = out.column<Float3>(8);
  for (std::size_t i = 0; i < in.size(); ++i) {
    const WeightedNeighborhood near(in, i);
    const Sums sums(in, i, near);
    const Principal p = principal_curvatures(unit_or_zero(in.value<Float3>(0, i)), sums, near);
    const bool found = p.direction != Vec3{};
    if (!found) ++out.degenerate;
    // Bounded so that a product is a number; a float holds far less anyway.
    const double a = std::min(p.k1 * near.scale(), 1e150), b = std::min(p.k2 * near.scale(), 1e150);
    k1[i] = saturated_float(a);
    k2[i] = saturated_float(b);
    direction[i] = stored_direction(p.direction);
    mean[i] = saturated_float((a + b) / 2);
    gaussian[i] = saturated_float(a * b);
    rms[i] = saturated_float(std::sqrt((a * a + b * b) / 2));
    absolute[i] = saturated_float(a + b);
    variation[i] = found ? surface_variation(near) : 0.0f;
    eigenvalues[i] = found ? normal_eigenvalues(sums, near) : Float3{};
  }
}

}  // namespace pointsweep
