// SPDX-License-Identifier: MIT
/// The vectors and symmetric matrices in which formulas are evaluated: the longest floating-point type, so that the
/// rounding of the evaluation itself does not count (2^-64 on x86-64).
#pragma once

#include <array>
#include <cmath>

namespace pointsweep::formulas {

using Real = long double;

struct Vector {
  Real x = 0, y = 0, z = 0;
};

inline Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vector operator*(Real s, Vector a) { return {s * a.x, s * a.y, s * a.z}; }
inline Real dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector cross(Vector a, Vector b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Real norm(Vector a) { return std::sqrt(dot(a, a)); }
inline bool is_finite(Vector a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }
/// v / |v|; 0 for 0.
inline Vector unit(Vector v) {
  const Real size = norm(v);
  return size > 0 ? (1 / size) * v : Vector{};
}
inline Real largest_component(Vector v) { return std::fmax(std::fabs(v.x), std::fmax(std::fabs(v.y), std::fabs(v.z))); }

struct Matrix {
  std::array<std::array<Real, 3>, 3> entry{};

  /// + s v vᵀ
  void add_outer_product(Real s, Vector v) {
    const Real c[3] = {v.x, v.y, v.z};
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) entry[a][b] += s * c[a] * c[b];
  }
  Real trace() const { return entry[0][0] + entry[1][1] + entry[2][2]; }
};

inline Vector operator*(const Matrix& m, Vector v) {
  const auto row = [&](std::size_t a) { return m.entry[a][0] * v.x + m.entry[a][1] * v.y + m.entry[a][2] * v.z; };
  return {row(0), row(1), row(2)};
}

}  // namespace pointsweep::formulas
