// SPDX-License-Identifier: MIT
/// Elliptical splats: Section 4.3.3 of the paper, in both variants.
#pragma once

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// All in float32.
struct Splat {
  Estimate axis;    ///< unit major axis, in the tangent plane
  Estimate length;  ///< major semi-axis
  Estimate ratio;   ///< minor over major semi-axis, in [1/8, 1]
};

/// The values that the variant from curvature reads of the point.
struct CurvatureHere {
  Estimate k1, k2, k1_direction;
};

/// The ellipse in the tangent plane of n_i. Without `curvature`: the major axis is the eigenvector of the largest
/// eigenvalue of M_i (Equation 1), brought into the plane (see tangent.h; the other axis is that of λ1), and the ratio
/// √(λ1/λ2). With it: the major axis is n_i × k1_direction and the ratio √(k2/k1); where k1_direction or k1 is 0, as
/// without. Ratios below 1/8 are 1/8.
///
/// The length is the 8th smallest of q_j = √(x² + (y/ratio)²) over the neighbours off p_i, with x and y the
/// coordinates of p_j - p_i along the axes; of only m < 8 such neighbours it is √(8/m) times the largest, so that the
/// area is in proportion. Neighbours whose x and y are
/// 0 do not count. All are 0 without a normal, without a neighbour that counts, or where an offset is not finite.
Splat splat(const Place& p, const Estimate& n, std::span<const Place> neighbors, const CurvatureHere* curvature);

}  // namespace pointsweep::formulas
