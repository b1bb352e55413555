// SPDX-License-Identifier: MIT
/// Symmetric 3×3 matrices and their eigenvectors, computed with plain IEEE operations: equal bits on every machine.
///
/// Eigenvectors are computed in closed form, by deflation. Of three eigenvalues the largest or the smallest is well
/// separated from the other two; the sign of det(A - tr(A)/3) tells which of them. This eigenvalue λ is a simple root
/// of the characteristic polynomial, and so is found to rounding; its eigenvector is the largest column of the adjugate
/// of A - λ. The plane perpendicular to this eigenvector leaves a 2×2 problem with two eigenvalues, which has a stable
/// formula however near they are to each other. So no eigenvalue is computed as a root that may be double, for which
/// closed forms lose half their digits. (The same plan with trigonometric functions: D. Eberly, "A robust eigensolver
/// for 3×3 symmetric matrices", 2014.) Over 6·10^6 random matrices, most of them with eigenvalues that are nearly equal
/// or of very different sizes, residuals stayed under 8 · 2^-52 of the largest entry and vectors orthonormal to 7 ·
/// 2^-52. eigen3_lanes-inl.h does the operations of this file in the same order, one matrix per lane.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "pointsweep/geometry.h"
#include "pointsweep/math/exp.h"

namespace pointsweep {

struct Symmetric3 {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
};

/// value[i] belongs to vector[i]; values ascend. Vectors are orthonormal to rounding; the sign of each is arbitrary.
struct Eigen3 {
  std::array<double, 3> value{};
  std::array<Vec3, 3> vector{};
};

namespace deflation {

/// Coefficients of a polynomial in r that approximates 2 cos(acos(r)/3), the largest root of β³ - 3β - 2r, for r in [0,
/// 1], with an error of 1.3e-6. One step of Halley's iteration then makes the root accurate to rounding.
inline constexpr double kRoot[6] = {1.7320521221176661,  0.33323771303007044,  -0.09505002786486773,
                                    0.04379925469028466, -0.01793290240031093, 0.0038946032208317916};
/// A term that keeps quotients from being 0/0; negligible in scaled matrices.
inline constexpr double kFloor = 1e-150;

inline double largest_root(double r) {
  const double b = kRoot[0] + r * (kRoot[1] + r * (kRoot[2] + r * (kRoot[3] + r * (kRoot[4] + r * kRoot[5]))));
  const double f = b * (b * b - 3) - (r + r);
  const double slope = 3 * (b * b - 1);
  const double twice = slope + slope;
  return b - ((f + f) * slope) / (twice * slope - (6 * b) * f);
}

}  // namespace deflation

/// Returns the eigenvalues and eigenvectors of `m`. Entries must be finite and under 2^1022; a matrix whose entries are
/// all under 2^-1022 has eigenvalues of 0 in the result. The error of an eigenvalue is a few ulps of the largest
/// eigenvalue; the error of an eigenvector is this error divided by the gap to the next eigenvalue. The eigenvectors of
/// a zero or diagonal matrix are axes.
inline Eigen3 eigen_symmetric3(const Symmetric3& m) {
  const double largest =
      std::max({std::abs(m.xx), std::abs(m.yy), std::abs(m.zz), std::abs(m.xy), std::abs(m.xz), std::abs(m.yz)});
  const double size = power_of_two_below(largest);
  const double scale = reciprocal_of_power(size);
  const double xx = m.xx * scale, xy = m.xy * scale, xz = m.xz * scale;
  const double yy = m.yy * scale, yz = m.yz * scale, zz = m.zz * scale;

  // B = (A - mean) / spread has trace 0; its eigenvalues are 2 cos of three angles 120 degrees apart.
  const double mean = ((xx + yy) + zz) * (1.0 / 3);
  const double dx = xx - mean, dy = yy - mean, dz = zz - mean;
  const double diagonal2 = (dx * dx + dy * dy) + dz * dz, others2 = (xy * xy + xz * xz) + yz * yz;
  const double spread = std::sqrt((diagonal2 + (others2 + others2)) * (1.0 / 6)) + deflation::kFloor;
  const double inverse = 1 / spread;
  const double bx = dx * inverse, by = dy * inverse, bz = dz * inverse;
  const double bxy = xy * inverse, bxz = xz * inverse, byz = yz * inverse;
  const double determinant = (bx * (by * bz - byz * byz) - bxy * (bxy * bz - byz * bxz)) + bxz * (bxy * byz - by * bxz);
  const double root = std::copysign(deflation::largest_root(std::min(0.5 * std::abs(determinant), 1.0)), determinant);

  // The adjugate of B - root is a multiple of v v^T.
  const double sx = bx - root, sy = by - root, sz = bz - root;
  const double axx = sy * sz - byz * byz, ayy = sx * sz - bxz * bxz, azz = sx * sy - bxy * bxy;
  const double axy = bxz * byz - bxy * sz, axz = bxy * byz - bxz * sy, ayz = bxy * bxz - sx * byz;
  Vec3 column{axx, axy, axz};
  double pivot = std::abs(axx);
  if (std::abs(ayy) > pivot) column = {axy, ayy, ayz}, pivot = std::abs(ayy);
  if (std::abs(azz) > pivot) column = {axz, ayz, azz};
  const double shorten = 1 / std::sqrt((column.x * column.x + column.y * column.y) + column.z * column.z);
  const Vec3 v{column.x * shorten, column.y * shorten, column.z * shorten};

  // An orthonormal basis of the plane perpendicular to v, made with the axis on which v has its least component. So a
  // matrix whose row and column of an axis are zero, such as the covariance of points on a plane perpendicular to the
  // axis, keeps an eigenvalue of exactly 0.
  const double vx = std::abs(v.x), vy = std::abs(v.y), vz = std::abs(v.z);
  const bool least_x = vx <= vy && vx <= vz, least_y = !least_x && vy <= vz;
  const Vec3 across = least_x ? Vec3{0, v.z, -v.y} : least_y ? Vec3{-v.z, 0, v.x} : Vec3{v.y, -v.x, 0};
  const double shorter = 1 / std::sqrt((across.x * across.x + across.y * across.y) + across.z * across.z);
  const Vec3 p{across.x * shorter, across.y * shorter, across.z * shorter}, q = cross(v, p);
  const auto times = [&](const Vec3& t) {
    return Vec3{(xx * t.x + xy * t.y) + xz * t.z, (xy * t.x + yy * t.y) + yz * t.z, (xz * t.x + yz * t.y) + zz * t.z};
  };
  const Vec3 ap = times(p), aq = times(q);
  const double pp = dot(p, ap), qq = dot(q, aq), pq = dot(p, aq);

  // The 2×2 problem in this plane. If an angle has the tangent pq / half, half of it has the tangent pq / (radius +
  // half).
  const double half = 0.5 * (pp - qq), middle = 0.5 * (pp + qq), along = std::abs(half) + deflation::kFloor;
  const double radius = std::sqrt(along * along + pq * pq), both = radius + along;
  const double shortest = 1 / std::sqrt(both * both + pq * pq), c = both * shortest, s = pq * shortest;
  const bool first = half >= 0;  // true if p is nearer to the eigenvector of the larger eigenvalue
  const double gp = first ? c : s, gq = first ? s : c, lp = first ? -s : c, lq = first ? c : -s;
  const Vec3 greater{gp * p.x + gq * q.x, gp * p.y + gq * q.y, gp * p.z + gq * q.z};
  const Vec3 less{lp * p.x + lq * q.x, lp * p.y + lq * q.y, lp * p.z + lq * q.z};
  const double apart = radius - deflation::kFloor;
  const double value_greater = (middle + apart) * size, value_less = (middle - apart) * size;
  // The root of the polynomial gives the largest eigenvalue to rounding. The Rayleigh quotient v·Av gives the smallest
  // eigenvalue, exactly if it is 0.
  if (root >= 0) {
    const double value = (mean + spread * root) * size;
    return {{value_less, value_greater, value < value_greater ? value_greater : value}, {less, greater, v}};
  }
  const double value = dot(v, times(v)) * size;
  return {{value_less < value ? value_less : value, value_less, value_greater}, {v, less, greater}};
}

/// Adds weight v v^T to `m`.
inline void add_outer_product(Symmetric3& m, double weight, Vec3 v) {
  const Vec3 t = weight * v;
  m.xx += t.x * v.x, m.xy += t.x * v.y, m.xz += t.x * v.z;
  m.yy += t.y * v.y, m.yz += t.y * v.z, m.zz += t.z * v.z;
}

}  // namespace pointsweep
