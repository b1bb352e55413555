// SPDX-License-Identifier: MIT
/// The value of a formula at a point, with a bound for its distance from every correct evaluation.
///
/// Operators evaluate their formulas in a documented precision: the weights θ of Equations 1 and 2 in single, all else
/// in double, results rounded to the type of the attribute. Each formula bounds the effect on its result of these
/// roundings and of the errors of the values that it reads: to first order, with the actual eigenvalue gaps (Weyl's
/// inequality for eigenvalues, Davis and Kahan, "The rotation of eigenvectors by a perturbation", 1970, for
/// eigenvectors). So no tolerance is a free parameter: all follow from the data.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace pointsweep::formulas {

/// The longest floating-point type, so that the rounding of the check's own arithmetic (2^-64 on x86-64) is negligible.
using Real = long double;

/// The vectors in which formulas are evaluated.
struct Vector {
  Real x = 0, y = 0, z = 0;

  Real operator[](std::size_t axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  Real& operator[](std::size_t axis) { return axis == 0 ? x : axis == 1 ? y : z; }
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

/// Returns v / |v|; 0 if |v| is 0 or NaN.
inline Vector unit(Vector v) {
  const Real size = norm(v);
  return size > 0 ? (1 / size) * v : Vector{};
}

inline Real largest_component(Vector v) { return std::fmax(std::fabs(v.x), std::fmax(std::fabs(v.y), std::fabs(v.z))); }

/// Returns whether all components are finite and lie in the range of float64.
inline bool fits_double(Vector v) { return is_finite(v) && largest_component(v) <= std::numeric_limits<double>::max(); }

struct Matrix {
  std::array<std::array<Real, 3>, 3> entry{};

  /// Adds s v vᵀ to the matrix.
  void add_outer_product(Real s, Vector v) {
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) entry[a][b] += s * v[a] * v[b];
  }
  Real trace() const { return entry[0][0] + entry[1][1] + entry[2][2]; }
};

inline Vector operator*(const Matrix& m, Vector v) {
  const auto row = [&](std::size_t a) { return m.entry[a][0] * v.x + m.entry[a][1] * v.y + m.entry[a][2] * v.z; };
  return {row(0), row(1), row(2)};
}

inline constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
inline constexpr Real kNaN = std::numeric_limits<Real>::quiet_NaN();
inline constexpr Real kSingle = 0x1p-24L;  ///< largest relative error of rounding to a normal float32
inline constexpr Real kDouble = 0x1p-53L;  ///< largest relative error of rounding to a normal float64

/// Returns a bound of the relative error of a weight exp(-x) in single precision, due to the rounding of exp() and of
/// x. The bound times exp(-x) is at most 1.2e-7.
inline Real single_weight_error(Real x) { return 2 * kSingle * (1 + x); }
/// Returns a bound of the relative error of a weight exp(-x) in double precision.
inline Real double_weight_error(Real x) { return 16 * kDouble * (1 + x); }
/// Returns a bound of the error of a sum of `terms` numbers in double precision, and of some twenty operations after
/// it, relative to the sum of the magnitudes of the numbers.
inline Real rounding_of_sum(std::size_t terms) { return (static_cast<Real>(terms) + 64) * kDouble; }

/// A position, and a bound of its distance from the position that the operator reads. The bound is 0 unless an operator
/// has moved the point.
struct Place {
  Vector at;
  Real error = 0;
};

/// An estimate of the value of an attribute with up to three components. An estimate is open if the data do not decide
/// the value.
struct Estimate {
  Vector value;              ///< a scalar is in x
  Real error = 0;            ///< bound of the distance from any correct value; infinite for an open estimate
  bool either_sign = false;  ///< true if the negative value is also correct
  /// True if the data are so near to a limit that 0, the value for undefined data, is also correct.
  bool may_be_undefined = false;

  bool is_open() const { return !(error < kInfinity); }
};

/// Returns whether the value of an estimate is uncertain: the estimate is open, or the value may be undefined.
inline bool in_doubt(const Estimate& e) { return e.is_open() || e.may_be_undefined; }
/// Returns an estimate without error.
inline Estimate exactly(Real value) { return {.value = {value, 0, 0}}; }
/// Returns an estimate of a number with a bound of its error.
inline Estimate scalar(Real value, Real error) { return {.value = {value, 0, 0}, .error = error}; }
/// Returns the documented value, 0, for data that define no value.
inline Estimate undefined() { return {}; }
/// Returns an open estimate, for data that do not decide the correct value.
inline Estimate open() { return {.value = {}, .error = kInfinity, .either_sign = true, .may_be_undefined = true}; }

/// The least and the greatest value that a number may have.
struct Range {
  Real low = 0, high = 0;
};
inline Range around(Real value, Real error) { return {value - error, value + error}; }
inline Range not_negative(Range r) { return {std::max<Real>(r.low, 0), std::max<Real>(r.high, 0)}; }
inline Range root(Range r) { return {std::sqrt(r.low), std::sqrt(r.high)}; }
/// Returns the range of the quotient of two numbers that are not negative.
inline Range ratio(Range numerator, Range denominator) {
  return {denominator.high > 0 ? numerator.low / denominator.high : 0,
          denominator.low > 0 ? numerator.high / denominator.low : kInfinity};
}

/// Returns the estimate of a number that is stored as float32. Before this rounding, correct evaluations lie in
/// `range`.
inline Estimate single_scalar(Real value, Range range) {
  const Real error = std::max(range.high - value, value - range.low);
  return scalar(value, error + kSingle * (std::fabs(value) + error) + 0x1p-149L);
}
/// Returns the estimate of a unit vector that is stored as three float32; open if `error` is not below 1.
inline Estimate single_direction(Vector value, Real error) {
  return {.value = value, .error = error < 1 ? error + kSingle : kInfinity};
}

}  // namespace pointsweep::formulas
