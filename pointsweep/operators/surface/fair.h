// SPDX-License-Identifier: MIT
/// Feature-preserving smoothing in one pass (paper Section 4.3.4, Equation 3).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"

namespace pointsweep {

/// p_i' = 1/w_i Σ_j Π_j(p_i) a_j f(|p_j - p_i|) g(|Π_j(p_i) - p_i|),  j over N_i and i itself, w_i the sum of the
/// weights a_j f g, with the Gaussians f and g of FairOptions.
///
/// Π_j(p_i) is the projection of p_i onto the tangent plane of p_j, as the symbol says and as in Jones, Durand and
/// Desbrun, "Non-iterative, feature-preserving mesh smoothing" (2003), which the paper extends. The paper's sentence
/// has i and j exchanged; then p_i would never leave its own tangent plane. For j = i the projection is p_i, with
/// weight a_i. a_j is the area of the splat of p_j, π length² ratio. The sign of n_j has no effect. A neighbour without
/// a normal, a splat or a finite place does not count. All is in double.
///
/// Makes "position". The point does not move, and counts as degenerate, if no neighbour that counts has a weight above
/// 0, or if the moved position is not finite. Normals and splats describe the old positions until they are made again.
class Fair : public LocalOperator {
 public:
  /// Throws UsageError unless both widths are positive and finite, and have finite reciprocals.
  explicit Fair(const FairOptions& options);
  std::string name() const override { return "fair"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;
  std::array<bool, 3> changes_system() const override { return {}; }

 private:
  struct Pull;
  void collect(const Neighborhoods& in, std::size_t i, std::vector<Pull>& pulls, std::vector<double>& exponents) const;
  static std::optional<Vec3> shift(double own, const std::vector<Pull>& pulls, const std::vector<double>& falloffs);
  double inverse_f_, inverse_g_;
};

}  // namespace pointsweep
