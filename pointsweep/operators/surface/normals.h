// SPDX-License-Identifier: MIT
/// Unit normals of the surface the points were taken from (paper Section 3.2, Equation 1).
#pragma once

#include <array>
#include <span>
#include <string>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"
#include "pointsweep/points/degenerate_points.h"

namespace pointsweep {

/// n_i = eigenvector of the smallest eigenvalue of
///   M_i = 1/|N_i| Σ_j (p_j - p_i)(p_j - p_i)^T θ(|p_j - p_i|),  θ(r) = exp(-r²/2σ²),  σ² = π max_j |p_j - p_i|² /
///   |N_i|,
/// with p_i itself, not the mean, as the centre, |N_i| without p_i, sums in the order of the neighbours, and
/// eigenvalues λ0 <= λ1 <= λ2. θ is in single precision, all else in double up to the rounding to float32: n_i is right
/// to about 2e-7 + 1e-7 λ1 / (λ1 - λ0) radians.
///
/// Makes "normal". It is (0, 0, 0), and the point counts as degenerate, where the data define no plane: fewer than two
/// neighbours; all of them on p_i; p_i and its neighbours on a line to rounding, that is λ1 <= 1e-12 λ2 (the width is
/// at most a millionth of the length) or, more exactly, λ1 <= 1e-12 λ2 + ρ² mean_j θ, with ρ = 2^-51 of the largest
/// coordinate of p_i, the rounding error of coordinates in double; or offsets that overflow or are not finite, as to a
/// neighbour that an earlier stage has moved to infinity.
class Normals : public LocalOperator {
 public:
  /// Throws UsageError for options out of range or in conflict. Messages about a conflict begin with `place`.
  explicit Normals(const NormalsOptions& options = {}, const std::string& place = "normals");
  std::string name() const override { return "normals"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;

 private:
  NormalsOptions options_;
};

/// Computes the unit normal of every point of the batch, with the sign that makes the component of largest magnitude,
/// or the first of several, positive. Points that are degenerate by the definition of Normals get (0, 0, 0) and are
/// marked as such. The bits depend only on a point's neighbourhood: not on the instruction set or the batch.
void unoriented_normals(const Neighborhoods& in, std::span<std::array<float, 3>> normals, DegeneratePoints& degenerate);

/// Returns the normal with the opposite sign. Computes 0 - n, which is never -0, instead of -n, so that a component of
/// 0 does not show whether the normal was flipped.
inline std::array<float, 3> flipped(const std::array<float, 3>& n) { return {0.0f - n[0], 0.0f - n[1], 0.0f - n[2]}; }

}  // namespace pointsweep
