// SPDX-License-Identifier: MIT
/// Principal curvatures of the surface, from how its normals vary (paper Section 4.3.2, Equation 2).
#pragma once

#include <array>
#include <span>
#include <string>

#include "pointsweep/operator.h"
#include "pointsweep/points/degenerate_points.h"

namespace pointsweep {

/// Computes curvatures from the second moments of the normals of the neighbours N_i of a point, which the paper defines
/// as
///   C_i = 1/|N_i| Σ_j n_j n_j^T θ(|p_j - p_i|),  θ as in Equation 1.
/// n n^T does not depend on the sign of n: normals need no orientation, and curvatures have no sign.
///
/// The largest eigenvalue of C_i belongs to the mean normal; the two smaller eigenvalues are second moments of the
/// components of the normals perpendicular to the mean normal. Over a short distance s along a direction of curvature
/// κ, the normal turns by the angle κ s, so
///   κ² = (second moment of the normals across their mean) / (variance of the positions along the same direction).
/// The paper does not describe this step from moments to curvatures. This library takes θ = 1, that is, equal weights,
/// since θ of Equation 1 effectively weights about six neighbours for any k. Normals estimated with that θ have errors
/// that differ between points as far apart as these six neighbours, and that are a fixed fraction of κ at any density;
/// a mean over only six neighbours leaves such errors in the result. With equal weights the errors decrease as k grows.
///
/// In full, over the m neighbours that have a normal, u_j = n_j / |n_j|:
///   S = 1/m Σ_j u_j u_j^T, with eigenvalues μ0 <= μ1 <= μ2 and eigenvectors e0, e1, e2;
///   D = 1/m Σ_j (p_j - p̄)(p_j - p̄)^T, p̄ the mean of the p_j;
///   t1 = unit vector in the tangent plane of n_i: along the projection of e1, if |e1·n_i| <= |e0·n_i|, else along
///   e0 × n_i; t2 = n_i × t1.
/// The curvatures along t1 and t2 are √(μ1 / t1^T D t1) and √(μ0 / t2^T D t2). k1 is the larger of the two, and
/// k1_direction its direction. S and D do not depend on n_i, so an error of n_i only tilts the plane of t1 and t2. All
/// sums are in double, θ of C_i and M_i below is in single precision, and results are rounded to float32.
///
/// Makes "k1" "k2" (k1 >= k2 >= 0), "k1_direction", "mean_curvature" (k1 + k2)/2, "gaussian_curvature" k1 k2,
/// "rms_curvature" √((k1² + k2²)/2), "absolute_curvature" k1 + k2, "surface_variation" λ0/(λ0 + λ1 + λ2) of M_i
/// (Equation 1), and "normal_eigenvalues", the eigenvalues of C_i with θ as in the paper, ascending. If k1 and k2 are
/// equal (a sphere, a plane), k1_direction is an arbitrary tangent.
///
/// All are 0, and the point counts as degenerate, where it has no normal, where fewer than three neighbours have a
/// normal, or where the neighbours with normals lie on a line to rounding: det <= (1e-12 trace + ρ²) trace, with the
/// determinant and the trace of D within the tangent plane and ρ = 2^-51 of the largest coordinate of p_i; or where an
/// offset overflows or is not finite.
///
/// Bias on dense noiseless surfaces: true normals give none on spheres and cylinders. Normals estimated from the same
/// neighbourhoods give mean errors of k1 and k2 under 4 % at k = 64 and 8 % at k = 32; see docs/paper.md.
class Curvature : public LocalOperator {
 public:
  std::string name() const override { return "curvature"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;
};

Attribute k1_attribute();
Attribute k2_attribute();
Attribute k1_direction_attribute();

/// The columns of Curvature. Each is as long as the batch, or empty if it is not wanted.
struct CurvatureColumns {
  std::span<float> k1, k2;
  std::span<std::array<float, 3>> direction;  ///< direction of k1
  std::span<float> mean, gaussian, rms, absolute;
  std::span<float> surface_variation;
  std::span<std::array<float, 3>> normal_eigenvalues;  ///< eigenvalues of C_i, ascending

  /// Returns whether a result of Equations 1 and 2 with their θ is wanted.
  bool weighted() const { return !surface_variation.empty() || !normal_eigenvalues.empty(); }
};

/// Computes the curvatures of all points of the batch. The first attribute read, of points and of neighbours, is the
/// normal. Points without a result get 0 and are marked as degenerate. The bits depend only on a point's neighbourhood:
/// not on the instruction set or the batch. About 0.2 µs per point with 8 neighbours on one core with AVX2.
void curvatures(const Neighborhoods& in, const CurvatureColumns& out, DegeneratePoints& degenerate);

}  // namespace pointsweep
