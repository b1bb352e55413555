// SPDX-License-Identifier: MIT
/// Equation 1 of the paper: neighbours with their weights θ, the matrix M_i, and normals.
#pragma once

#include <span>
#include <vector>

#include "pointsweep/verify/formulas/eigen.h"
#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

struct WeightedOffset {
  Vector d;               ///< p_j - p_i
  Real error = 0;         ///< error of d
  Real weight = 0;        ///< θ(|d|) / theta_of_nearest
  Real weight_error = 0;  ///< absolute error of `weight`
};

/// The neighbours N_i (without p_i) and their weights in Equations 1 and 2: θ(r) = exp(-r²/2σ²) with σ² = π max_j |p_j
/// - p_i|² / |N_i|.
struct WeightedNeighbors {
  std::vector<WeightedOffset> offsets;
  Real farthest = 0;        ///< max_j |p_j - p_i|
  Real farthest_error = 0;  ///< error of `farthest`
  /// θ of the nearest neighbour that does not coincide with p_i. All weights are divided by this θ, so that not all of
  /// them underflow to 0.
  Real theta_of_nearest = 1;
  bool finite = true;  ///< true if all offsets are finite in float64

  Real mean_weight() const;
};

WeightedNeighbors weigh(const Place& p, std::span<const Place> neighbors);

/// Returns the eigenvalues and eigenvectors of M_i (Equation 1) divided by theta_of_nearest.
Spectrum equation1(const WeightedNeighbors& neighbors);

/// Returns a unit vector in the plane with unit normal n, from two orthogonal unit vectors: the direction of the
/// projection of `along` if `along` is not farther from the plane than `across`, else the direction in the plane
/// perpendicular to `across`. `error`: bound of the larger angular error of the two vectors, plus that of n.
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
  Estimate like;  ///< normal of the input, for Side::like
};

/// Returns the normal n_i, float32: the eigenvector of the smallest eigenvalue λ0 of
///   M_i = 1/|N_i| Σ_j (p_j - p_i)(p_j - p_i)ᵀ θ(|p_j - p_i|).
/// The normal is 0 with fewer than two neighbours, if an offset is not finite, and if the neighbours define no plane:
/// λ1 <= 1e-12 λ2 + ρ² mean_j θ_j, where ρ is 2^-51 times the largest magnitude of a coordinate of p_i.
Estimate normal(const Place& p, std::span<const Place> neighbors, const Facing& facing);

}  // namespace pointsweep::formulas
