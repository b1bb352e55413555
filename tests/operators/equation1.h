// SPDX-License-Identifier: MIT
/// Equation 1 for tests, in two forms: in long double as in the paper, and in the scalar operations of a lane of the
/// vector kernel.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/math/exp.h"
#include "pointsweep/math/symmetric3.h"

namespace pointsweep {

/// The paper's formula with Eigen's solver. The error of the normal is at most a relative error of the matrix divided
/// by `gap` = (λ1 - λ0) / λ2, or a relative error of the weights θ divided by `own_gap` = (λ1 - λ0) / λ1, because an
/// error of θ changes each term of the sum by a share of that term.
struct Equation1 {
  Vec3 normal;
  double gap = 0, own_gap = 0;

  Equation1(std::span<const Vec3> points, std::size_t i, std::span<const std::uint32_t> neighbors) {
    using Real = long double;
    using Vector = Eigen::Matrix<Real, 3, 1>;
    const auto offset = [&](std::uint32_t j) {
      return Vector(Real(points[j].x) - points[i].x, Real(points[j].y) - points[i].y, Real(points[j].z) - points[i].z);
    };
    Real farthest2 = 0;
    for (const std::uint32_t j : neighbors) farthest2 = std::max(farthest2, offset(j).squaredNorm());
    const Real sigma2 = std::numbers::pi_v<Real> * farthest2 / Real(neighbors.size());
    Eigen::Matrix<Real, 3, 3> m = Eigen::Matrix<Real, 3, 3>::Zero();
    for (const std::uint32_t j : neighbors)
      m += offset(j) * offset(j).transpose() * std::exp(-offset(j).squaredNorm() / (2 * sigma2));
    m /= Real(neighbors.size());
    m /= m.trace();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<Real, 3, 3>> solver(m);
    const Vector n = solver.eigenvectors().col(0);
    normal = {double(n(0)), double(n(1)), double(n(2))};
    const auto& values = solver.eigenvalues();
    gap = double((values(1) - values(0)) / values(2)), own_gap = double((values(1) - values(0)) / values(1));
  }
};

/// Returns v or -v: the first of its largest components is positive. Replaces -0 by 0.
inline std::array<float, 3> canonical_direction(std::array<float, 3> v) {
  float largest = v[0];
  for (const std::size_t c : {1u, 2u}) largest = std::abs(v[c]) > std::abs(largest) ? v[c] : largest;
  for (float& c : v) c = (largest < 0 ? -c : c) + 0.0f;
  return v;
}

/// Returns the unoriented normal, with the operations of a lane of the vector kernel.
inline std::array<float, 3> scalar_normal(std::span<const Vec3> points, std::size_t i,
                                          std::span<const std::uint32_t> neighbors) {
  if (neighbors.size() < 2) return {};
  const Vec3 p = points[i], far = points[neighbors.back()] - p;
  const auto magnitude = [](Vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); };
  if (!(magnitude(far) >= 0x1p-1022 && magnitude(far) < 0x1p1022)) return {};
  const double scale = reciprocal_of_power(power_of_two_below(magnitude(far)));
  const auto length2 = [](Vec3 v) { return (v.x * v.x + v.y * v.y) + v.z * v.z; };
  Vec3 near;
  for (std::size_t j = 0; near == Vec3{}; ++j) near = points[neighbors[j]] - p;
  const double near2 = length2(scale * near);
  const double falloff = (double(neighbors.size()) * (0.5 / std::numbers::pi)) / length2(scale * far);
  Symmetric3 m;
  double weights = 0;
  for (const std::uint32_t j : neighbors) {
    const Vec3 o = scale * (points[j] - p);
    const double theta = exp_negative(static_cast<float>(std::max(length2(o) - near2, 0.0) * falloff));
    const Vec3 t = theta * o;
    m.xx += t.x * o.x, m.xy += t.x * o.y, m.xz += t.x * o.z;
    m.yy += t.y * o.y, m.yz += t.y * o.z, m.zz += t.z * o.z;
    weights += theta;
  }
  const Eigen3 e = eigen_symmetric3(m);
  const double rounding = magnitude(p) * scale * 0x1p-51;
  if (!(e.value[1] > 1e-12 * e.value[2] + weights * (rounding * rounding))) return {};
  return canonical_direction({float(e.vector[0].x), float(e.vector[0].y), float(e.vector[0].z)});
}

}  // namespace pointsweep
