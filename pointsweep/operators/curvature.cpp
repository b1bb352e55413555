// SPDX-License-Identifier: MIT
#include "pointsweep/operators/curvature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "pointsweep/math/batch.h"
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

/// Sums over the neighbours that have a normal, and over all of them.
struct Sums {
  Symmetric3 moments;           // |N_i| M_i of Equation 1, of all neighbours
  Symmetric3 weighted_normals;  // |N_i| C_i of Equation 2
  Symmetric3 normals, positions;
  Vec3 position;
  double count = 0;

  Sums() = default;
  /// `theta` is room for the weights of all neighbours.
  Sums(const Neighborhoods& in, std::size_t i, const WeightedNeighborhood& near, std::vector<double>& theta) {
    near.thetas(theta);
    for (std::size_t j = 0; j < near.size(); ++j) {
      const Vec3 o = near.offset(j);
      add_outer_product(moments, theta[j], o);
      const Vec3 n = unit_or_zero(in.neighbor_value<Float3>(0, i, j));
      if (n == Vec3{}) continue;
      add_outer_product(weighted_normals, theta[j], n);
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

/// `e` is that of sums.normals, `rounding` that of the neighbourhood.
Principal principal_curvatures(Vec3 n, const Sums& sums, const Eigen3& e, double rounding) {
  if (n == Vec3{} || sums.count < 3) return {};
  Vec3 along = tangent(n, e.vector[1], e.vector[0]);
  const Vec3 across = cross(n, along);
  const double p1 = sums.variance(along), p2 = sums.variance(across), p12 = sums.covariance(along, across);
  const double spread = p1 + p2, noise = sums.count * (rounding * rounding);
  // The determinant over the trace is the smaller eigenvalue, to a factor of two: 0 for points on a line.
  if (!(p1 * p2 - p12 * p12 > (1e-12 * spread + noise) * spread)) return {};
  double k1 = std::sqrt(std::max(e.value[1], 0.0) / p1), k2 = std::sqrt(std::max(e.value[0], 0.0) / p2);
  if (k1 < k2) {
    std::swap(k1, k2);
    along = across;
  }
  return {k1, k2, along};
}

/// Of C_i, ascending; `share` is what was taken out of the sum.
Float3 normal_eigenvalues(const Eigen3& e, double share) {
  const auto value = [&](std::size_t v) { return static_cast<float>(std::max(e.value[v], 0.0) * share); };
  return {value(0), value(1), value(2)};
}

float surface_variation(const Eigen3& e) {
  const double sum = e.value[0] + e.value[1] + e.value[2];
  return sum > 0 ? static_cast<float>(std::max(e.value[0], 0.0) / sum) : 0.0f;
}

/// A few points at a time, so that their eigenvalues are found side by side.
struct Chunk {
  static constexpr std::size_t kPoints = 64;
  std::size_t size = 0;
  std::array<Sums, kPoints> sums;
  std::array<double, kPoints> scale, rounding, share;
  std::array<Symmetric3, 3 * kPoints> matrices;  // sums.normals, then sums.weighted_normals, then sums.moments
  std::array<Eigen3, 3 * kPoints> eigen;

  void gather(const Neighborhoods& in, std::size_t first, std::vector<double>& theta) {
    size = std::min(kPoints, in.size() - first);
    for (std::size_t c = 0; c < size; ++c) {
      const WeightedNeighborhood near(in, first + c);
      sums[c] = Sums(in, first + c, near, theta);
      scale[c] = near.scale();
      rounding[c] = near.rounding();
      share[c] = near.size() == 0 ? 0 : near.nearest_theta() / static_cast<double>(near.size());
      matrices[c] = sums[c].normals, matrices[size + c] = sums[c].weighted_normals;
    }
    for (std::size_t c = 0; c < size; ++c) matrices[2 * size + c] = sums[c].moments;
    batch_eigen_symmetric3({matrices.data(), 3 * size}, {eigen.data(), 3 * size});
  }
};

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
  std::vector<double> theta;
  Chunk chunk;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const std::size_t c = i % Chunk::kPoints;
    if (c == 0) chunk.gather(in, i, theta);
    const Vec3 normal = unit_or_zero(in.value<Float3>(0, i));
    const Principal p = principal_curvatures(normal, chunk.sums[c], chunk.eigen[c], chunk.rounding[c]);
    const bool found = p.direction != Vec3{};
    if (!found) ++out.degenerate;
    // Bounded so that a product is a number; a float holds far less anyway.
    const double a = std::min(p.k1 * chunk.scale[c], 1e150), b = std::min(p.k2 * chunk.scale[c], 1e150);
    k1[i] = saturated_float(a);
    k2[i] = saturated_float(b);
    direction[i] = stored_direction(p.direction);
    mean[i] = saturated_float((a + b) / 2);
    gaussian[i] = saturated_float(a * b);
    rms[i] = saturated_float(std::sqrt((a * a + b * b) / 2));
    absolute[i] = saturated_float(a + b);
    variation[i] = found ? surface_variation(chunk.eigen[2 * chunk.size + c]) : 0.0f;
    eigenvalues[i] = found ? normal_eigenvalues(chunk.eigen[chunk.size + c], chunk.share[c]) : Float3{};
  }
}

}  // namespace pointsweep
