// SPDX-License-Identifier: MIT
/// Features of the shape of a neighbourhood, from the eigenvalues of its covariance.
#pragma once

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// The definition of λ from the eigenvalues l.
enum class Lambda { raw, root, normalized };

/// float32, but for number_of_neighbors. P are the neighbours and, if it counts, p; n = |P|.
///   Σ = 1/n Σ_P (q - mean)(q - mean)ᵀ, eigenvalues l1 >= l2 >= l3, unit eigenvectors e1, e2, e3
struct Features {
  Estimate linearity, planarity, sphericity, omnivariance, anisotropy, eigenentropy, eigenvalue_sum, surface_variation;
  Estimate verticality;                   ///< 1 - |e3 · z|; 0 where l2 <= 1e-12 l1 + ρ², ρ as in normal()
  Estimate moment1_axis1, moment1_axis2;  ///< |Σ_P (q - p) · e|
  Estimate moment2_axis1, moment2_axis2;  ///< Σ_P ((q - p) · e)²
  Estimate height_range, number_of_neighbors;
};

/// All but number_of_neighbors and height_range are 0 where P lies at one place; height_range is 0 as well where an
/// offset is not finite.
Features features(const Place& p, std::span<const Place> neighbors, Lambda lambda, bool with_point);

}  // namespace pointsweep::formulas
