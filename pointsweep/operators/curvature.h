// SPDX-License-Identifier: MIT
/// Principal curvatures of the surface, from how its normals vary (paper Section 4.3.2, Equation 2).
#pragma once

#include <string>

#include "pointsweep/operators/operator.h"

namespace pointsweep {

/// From the covariance of the normals,
///   C_i = 1/|N_i| Σ_j n_j n_j^T θ(|p_j - p_i|),  θ as in Equation 1.
/// n n^T does not see signs: normals need no orientation, and curvatures come without sign.
///
/// The largest eigenvalue of C_i belongs to the mean normal; the two smaller ones, λ, are variances of the normal along
/// their eigenvectors. Over the way s to a neighbour a normal turns by κ s, so
///   κ² = λ / (variance of the positions along the same direction, under the same weights, about their mean).
/// The paper leaves this step out. Both variances are about means, so that an error of n_i itself does not count.
/// Directions are eigenvectors brought into the tangent plane of n_i; κ2's is n × k1_direction.
///
/// Makes "k1" "k2" (k1 >= k2 >= 0), "k1_direction", "mean_curvature" (k1 + k2)/2, "gaussian_curvature" k1 k2,
/// "rms_curvature" √((k1² + k2²)/2), "absolute_curvature" k1 + k2, and "surface_variation" λ0/(λ0 + λ1 + λ2) of M_i
/// (Equation 1). Where the directions of k1 and k2 tie (a sphere, a plane), k1_direction is some tangent.
///
/// All are 0, and the point counted as degenerate, where it has no normal, where fewer than three neighbours have one,
/// or where those lie on a line to rounding.
///
/// Bias, dense noiseless surfaces: with true normals none on spheres and cylinders, and under 1 % (k1) and 6 % (k2) on
/// a torus at k = 8, 2 % from k = 24 on. Normals estimated from the same neighbourhoods bring errors that are a fixed
/// share of κ at any density, since θ always weighs about six neighbours: see docs/attributes.md.
class Curvature : public Operator {
 public:
  std::string name() const override { return "curvature"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;
};

Attribute k1_attribute();
Attribute k2_attribute();
Attribute k1_direction_attribute();

}  // namespace pointsweep
