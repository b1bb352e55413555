// SPDX-License-Identifier: MIT
/// Feature-preserving smoothing: Equation 3 of the paper.
#pragma once

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// The values that Equation 3 reads of a point.
struct Surfel {
  Place place;
  Estimate normal, splat_length, splat_ratio;
};

/// p_i' = 1/w_i Σ_j Π_j(p_i) a_j f(|p_j - p_i|) g(|Π_j(p_i) - p_i|) over N_i and i itself, float64, with Π_j(p_i) the
/// projection of p_i onto the tangent plane of p_j, f(r) = exp(-r²/2F²), g(r) = exp(-r²/2G²) with standard deviations
/// F and G, a_j = π length² ratio of the splat of p_j, and w_i the sum of the weights. p_i projects to itself and
/// weighs a_i. Neighbours without a normal, a splat or a finite place do not count; without any that counts p_i stays.
Estimate faired(const Surfel& point, std::span<const Surfel> neighbors, Real f, Real g);

}  // namespace pointsweep::formulas
