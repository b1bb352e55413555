// SPDX-License-Identifier: MIT
/// Normals: Equation 1 of the paper.
#pragma once

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// The choice between the two directions of a normal.
struct Facing {
  enum class Side {
    none,       ///< the component of largest magnitude, the first of equal ones, is positive
    up,         ///< n_z >= 0
    viewpoint,  ///< (viewpoint - p_i)·n >= 0
    like,       ///< like·n >= 0
  };
  Side side = Side::none;
  Vector viewpoint;
  Estimate like;  ///< the normal of the input
};

/// n_i, float32: the eigenvector of the smallest eigenvalue λ0 of
///   M_i = 1/|N_i| Σ_j (p_j - p_i)(p_j - p_i)ᵀ θ(|p_j - p_i|).
/// 0 with fewer than two neighbours, where an offset is not finite, and where they define no plane: λ1 <= 1e-12 λ2 + ρ²
/// mean_j θ_j with ρ the 2^-51st part of the largest coordinate of p_i.
Estimate normal(const Place& p, std::span<const Place> neighbors, const Facing& facing);

}  // namespace pointsweep::formulas
