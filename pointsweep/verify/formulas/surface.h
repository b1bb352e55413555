// SPDX-License-Identifier: MIT
/// Formulas of the operators on surfaces: curvature, splats, fairing, features.
#pragma once

#include <span>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// Curvatures of a point, all in float32.
struct Curvatures {
  Estimate k1, k2;              ///< k1 >= k2 >= 0
  Estimate k1_direction;        ///< unit tangent vector, whose component of largest magnitude is positive
  Estimate mean;                ///< (k1 + k2) / 2
  Estimate gaussian;            ///< k1 k2
  Estimate rms;                 ///< √((k1² + k2²) / 2)
  Estimate absolute;            ///< k1 + k2
  Estimate surface_variation;   ///< λ0 / (λ0 + λ1 + λ2) of M_i
  Estimate normal_eigenvalues;  ///< eigenvalues of C_i, ascending
};

/// Returns the curvatures at p. `n`: normal of p; `normals`: normals of `neighbors`. With u = n / |n|, sums over the m
/// neighbours that have a normal, p̄ the mean of these neighbours, and
///   S = 1/m Σ_j u_j u_jᵀ with eigenvalues μ0 <= μ1 <= μ2 and eigenvectors e0, e1, e2,
///   D = 1/m Σ_j (p_j - p̄)(p_j - p̄)ᵀ,
///   t1 = e1 brought into the tangent plane of n_i (see tangent()), t2 = n_i × t1,
/// the curvatures along t1 and t2 are √(μ1 / t1ᵀ D t1) and √(μ0 / t2ᵀ D t2); k1 is the larger one.
/// C_i = 1/|N_i| Σ_j u_j u_jᵀ θ(|p_j - p_i|) includes all neighbours.
///
/// All values are 0 if n_i is 0, m < 3, an offset is not finite, or the m neighbours lie on a line: det <= (1e-12 trace
/// + ρ²) trace of D within the tangent plane, where ρ is 2^-51 times the largest magnitude of a coordinate of p_i.
Curvatures curvature(const Place& p, const Estimate& n, std::span<const Place> neighbors,
                     std::span<const Estimate> normals);

/// An ellipse. All values are float32.
struct Splat {
  Estimate axis;    ///< unit major axis, in the tangent plane
  Estimate length;  ///< major semi-axis
  Estimate ratio;   ///< minor over major semi-axis, in [1/8, 1]
};

/// The curvature at a point, from which splat() may take the axes.
struct CurvatureHere {
  Estimate k1, k2, k1_direction;
};

/// Returns the ellipse in the tangent plane of n_i. Without `curvature` (null, or if k1_direction or k1 is 0), the
/// major axis is the eigenvector of the largest eigenvalue of M_i (Equation 1), brought into the plane (see tangent();
/// `across` is the eigenvector of λ1), and the ratio is √(λ1/λ2). With `curvature`, the major axis is n_i ×
/// k1_direction and the ratio is √(k2/k1). Ratios below 1/8 become 1/8.
///
/// The length is the 8th smallest of q_j = √(x² + (y/ratio)²) over the neighbours off p_i, with x and y the coordinates
/// of p_j - p_i along the axes. With only m < 8 such neighbours it is √(8/m) times the largest q_j: the ellipse that
/// reaches the farthest of them is enlarged to 8/m times its area. Neighbours whose x and y are 0 do not count. All
/// values are 0 without a normal, without a neighbour that counts, or if an offset is not finite.
Splat splat(const Place& p, const Estimate& n, std::span<const Place> neighbors, const CurvatureHere* curvature);

/// The values that Equation 3 reads of a point.
struct Surfel {
  Place place;
  Estimate normal, splat_length, splat_ratio;
};

/// Returns p_i' = 1/w_i Σ_j Π_j(p_i) a_j f(|p_j - p_i|) g(|Π_j(p_i) - p_i|) over N_i and i itself, float64, with
/// Π_j(p_i) the projection of p_i onto the tangent plane of p_j, f(r) = exp(-r²/2F²), g(r) = exp(-r²/2G²) with standard
/// deviations F and G, a_j = π length² ratio of the splat of p_j, and w_i the sum of the weights. p_i projects to
/// itself with the weight a_i. Neighbours without a normal, without a splat or with non-finite coordinates do not
/// count; without a neighbour that counts, or if w_i is 0, p_i is unchanged.
Estimate faired(const Surfel& point, std::span<const Surfel> neighbors, Real f, Real g);

/// The ways in which features define λ from the eigenvalues l: λ = l, λ = √l, or λ = l divided by the sum of all three
/// l.
enum class Lambda { raw, root, normalized };

/// Features of P, in float32 except for number_of_neighbors. P contains the neighbours, and p if `with_point`; n = |P|.
/// The covariance 1/n Σ_P (q - mean)(q - mean)ᵀ has eigenvalues l1 >= l2 >= l3 and unit eigenvectors e1, e2, e3.
struct Features {
  Estimate linearity, planarity, sphericity, omnivariance, anisotropy, eigenentropy, eigenvalue_sum, surface_variation;
  Estimate verticality;                   ///< 1 - |e3 · z|; 0 if l2 <= 1e-12 l1 + ρ², with ρ as in normal()
  Estimate moment1_axis1, moment1_axis2;  ///< |Σ_P (q - p) · e| with e = e1 and e = e2
  Estimate moment2_axis1, moment2_axis2;  ///< Σ_P ((q - p) · e)² with e = e1 and e = e2
  Estimate height_range, number_of_neighbors;
};

/// Returns the features of P. All features except number_of_neighbors are 0 if all points of P coincide or an offset is
/// not finite.
Features features(const Place& p, std::span<const Place> neighbors, Lambda lambda, bool with_point);

}  // namespace pointsweep::formulas
