// SPDX-License-Identifier: MIT
/// Principal curvatures: Equation 2 of the paper, and from variances of normals to curvatures.
#pragma once

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// All in float32.
struct Curvatures {
  Estimate k1, k2;              ///< k1 >= k2 >= 0
  Estimate k1_direction;        ///< unit tangent; the component of largest magnitude positive
  Estimate mean;                ///< (k1 + k2) / 2
  Estimate gaussian;            ///< k1 k2
  Estimate rms;                 ///< √((k1² + k2²) / 2)
  Estimate absolute;            ///< k1 + k2
  Estimate surface_variation;   ///< λ0 / (λ0 + λ1 + λ2) of M_i
  Estimate normal_eigenvalues;  ///< eigenvalues of C_i, ascending
};

/// `normals` belong to `neighbors`. With u = n / |n|, sums over the m neighbours that have a normal, and
///   S = 1/m Σ_j u_j u_jᵀ with eigenvalues μ0 <= μ1 <= μ2 and eigenvectors e0, e1, e2,
///   D = 1/m Σ_j (p_j - p̄)(p_j - p̄)ᵀ,
///   t1 = e1 brought into the tangent plane of n_i (see tangent.h), t2 = n_i × t1,
/// the curvatures along t1 and t2 are √(μ1 / t1ᵀ D t1) and √(μ0 / t2ᵀ D t2); k1 is the larger one.
/// C_i = 1/|N_i| Σ_j u_j u_jᵀ θ(|p_j - p_i|) is of all neighbours.
///
/// All are 0 where n_i is 0, m < 3, an offset is not finite, or those m lie on a line: det <= (1e-12 trace + ρ²) trace
/// of D within the tangent plane, with ρ the 2^-51st part of the largest coordinate of p_i.
Curvatures curvature(const Place& p, const Estimate& n, std::span<const Place> neighbors,
                     std::span<const Estimate> normals);

}  // namespace pointsweep::formulas
