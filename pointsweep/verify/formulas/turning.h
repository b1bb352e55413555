// SPDX-License-Identifier: MIT
/// The side to which the normals of a component face, after their signs agree.
#pragma once

#include <optional>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// Takes the points of a component twice: first for centroid and extent, then with their signs for the votes.
class TurningVotes {
 public:
  void measure(Vector p);
  void vote(Vector p, Vector signed_normal, const std::optional<Vector>& viewpoint);

  /// Returns whether all signs are to be turned: where the larger in absolute value of Σ s n_z and Σ s n . (p - c) / e
  /// is negative, c the centroid and e the mean extent; with a viewpoint v, where Σ sign(s n . (v - p)) is. Nothing
  /// where the data do not tell: the operator's normals in sums are whole multiples of 2^-20.
  std::optional<bool> turns(bool has_viewpoint) const;

 private:
  Real points_ = 0;
  Vector sum_, low_{kInfinity, kInfinity, kInfinity}, high_{-kInfinity, -kInfinity, -kInfinity};
  Real up_ = 0, out_ = 0, offsets_ = 0;  ///< offsets_: Σ |p - c|, all components
  Real facing_ = 0, in_doubt_ = 0;
};

}  // namespace pointsweep::formulas
