// SPDX-License-Identifier: MIT
/// Points, directions and lengths under an affine map p' = A p + t.
#pragma once

#include <array>
#include <span>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// An affine map. Each number of the map has a bound of its distance from the float64 number with which the operator
/// computes.
class Affine {
 public:
  /// Makes the map of the first three rows of a 4×4 matrix (12 numbers), times `scale`, then moved by `translation`.
  Affine(std::span<const double> rows, double scale, Vector translation);
  /// Returns the inverse map, computed from cofactors.
  Affine inverse() const;

  /// Returns A p + t; a point that is not finite is returned unchanged.
  Place moved(const Place& p) const;
  /// Returns A v, scaled to the length of v.
  Estimate tangent(const Estimate& v) const;
  /// Returns A⁻ᵀ n, scaled to the length of n.
  Estimate normal(const Estimate& n) const;
  /// Returns the factor by which the map scales lengths: √(trace(AᵀA) / 3), or 1 if the root is within 1e-6 of 1.
  Real scale() const;

 private:
  Affine() = default;
  Vector column(std::size_t c) const { return {entry_[0][c], entry_[1][c], entry_[2][c]}; }
  Vector cofactors(std::size_t c) const { return cross(column((c + 1) % 3), column((c + 2) % 3)); }
  Real determinant() const { return dot(column(0), cofactors(0)); }
  /// Returns `directed`, scaled to the length of `before`, and the error of the result. If `directed` is 0, the value
  /// of `before` is returned.
  Estimate of_same_length(Vector directed, const Estimate& before) const;

  std::array<std::array<Real, 4>, 3> entry_{}, error_{};
};

}  // namespace pointsweep::formulas
