// SPDX-License-Identifier: MIT
/// Eigenvalues and eigenvectors of a symmetric matrix by Jacobi's rotations (C. G. J. Jacobi 1846; Golub and Van Loan,
/// "Matrix Computations", Section 8.5), which need no special case for equal eigenvalues. The operators use a closed
/// form instead.
#pragma once

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// Eigenvalues and unit eigenvectors: value[i] belongs to vector[i], and values ascend. Signs of vectors are arbitrary.
struct Eigen {
  std::array<Real, 3> value{};
  std::array<Vector, 3> vector{};
};

Eigen eigen_of(const Matrix& symmetric);

/// Eigenvalues and eigenvectors of a matrix whose entries are estimates, with error bounds.
struct Spectrum : Eigen {
  std::array<Real, 3> value_error{};   ///< bounds of the errors of the eigenvalues
  std::array<Real, 3> vector_error{};  ///< bound of the angular error of each eigenvector in radians, or infinite
};

/// Returns the spectrum of M with error bounds. uncertainty(u, v) returns a bound for the error of uᵀ M v, for unit
/// vectors u and v.
template <class Uncertainty>
Spectrum spectrum_of(const Matrix& m, Uncertainty uncertainty) {
  Spectrum s{eigen_of(m), {}, {}};
  Real u[3][3];
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) u[a][b] = uncertainty(s.vector[a], s.vector[b]);
  for (std::size_t a = 0; a < 3; ++a) {
    s.value_error[a] = u[a][a];
    for (std::size_t b = 0; b < 3; ++b) {
      if (a == b) continue;
      const Real gap = std::fabs(s.value[a] - s.value[b]), sure = gap - u[a][a] - u[b][b];
      s.value_error[a] += std::min(u[a][b], gap > 0 ? u[a][b] * u[a][b] / gap : kInfinity);
      s.vector_error[a] += sure > 0 ? u[a][b] / sure : kInfinity;
    }
    // First-order bounds hold below half a radian, where an arc is at most a tenth longer than its sine.
    s.vector_error[a] = s.vector_error[a] < 0.5L ? 1.1L * s.vector_error[a] : kInfinity;
  }
  return s;
}

/// Returns the square of ρ, the rounding of positions: 2^-51 times the largest magnitude of a coordinate of p.
inline Real rho2(const Place& p) {
  const Real rho = 0x1p-51L * largest_component(p.at);
  return rho * rho;
}

/// The finding that a neighbourhood defines no plane, with the doubt that rounding leaves.
struct PlaneDoubt {
  bool sure;      ///< true if the neighbourhood surely defines no plane
  bool possible;  ///< true if the neighbourhood may define no plane
};
/// Decides whether λ1 <= 1e-12 λ2 + ρ² `weight`. `weight`: mean weight of the neighbours in the matrix.
inline PlaneDoubt no_plane_in(const Spectrum& s, const Place& p, Real weight) {
  const Real limit = 1e-12L * s.value[2] + rho2(p) * weight;
  const Real doubt = s.value_error[1] + 1e-12L * s.value_error[2] + 1e-5L * limit;
  return {s.value[1] + doubt <= limit, s.value[1] - doubt <= limit};
}

}  // namespace pointsweep::formulas
