// SPDX-License-Identifier: MIT
/// Neighbours with the weight θ of Equation 1, M_i, and normals.
#pragma once

#include <vector>

#include "pointsweep/verify/formulas/eigen.h"
#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

struct WeightedOffset {
  Vector d;               ///< p_j - p_i
  Real error = 0;         ///< error of d
  Real weight = 0;        ///< θ(|d|)
  Real weight_error = 0;  ///< absolute error of θ
};

/// N_i as Equations 1 and 2 see it: θ(r) = exp(-r²/2σ²) with σ² = π max_j |p_j - p_i|² / |N_i|, N_i without p_i.
struct WeightedNeighbors {
  std::vector<WeightedOffset> offsets;
  Real farthest = 0;        ///< max_j |p_j - p_i|
  Real farthest_error = 0;  ///< error of `farthest`
  /// Weights are θ over θ of the nearest neighbour off p_i, which is this, so that they never vanish all together.
  Real theta_of_nearest = 1;
  bool finite = true;  ///< no offset overflows double precision

  Real mean_weight() const;
};

WeightedNeighbors weigh(const Place& p, std::span<const Place> neighbors);

/// M_i of Equation 1 over theta_of_nearest, and its eigenvectors.
Spectrum equation1(const WeightedNeighbors& neighbors);

/// Returns a direction in the plane with unit normal n, from two orthogonal unit vectors: the projection of `along` if
/// it is nearer to the plane than `across`, else the direction in the plane perpendicular to `across`. `error` bounds
/// the angular error of the two vectors and n.
Estimate tangent(Vector n, Vector along, Vector across, Real error);

/// The choice between the two directions of a normal.
struct Facing {
  enum class Side {
    none,       ///< the component of largest magnitude (the first of equal ones) is positive
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
