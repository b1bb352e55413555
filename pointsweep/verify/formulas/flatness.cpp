// SPDX-License-Identifier: MIT
#include "pointsweep/verify/formulas/flatness.h"

#include "pointsweep/verify/formulas/eigen.h"

namespace pointsweep::formulas {

void Flatness::measure(Vector p) {
  if (points_ == 0) first_ = p;
  points_ += 1;
  sum_ = sum_ + (p - first_);
}

void Flatness::add(Vector p) { covariance_.add_outer_product(1, p - first_ - (1 / points_) * sum_); }

/// A point that is displaced by d changes the root of the mean square by d at most.
Estimate Flatness::residual() const {
  if (points_ < 4) return {};
  const Real displaced = std::sqrt(Real{3}) * 0x1p-41L;
  const Real least = std::fmax(0, eigen_of(covariance_).value[0]) / points_, all = covariance_.trace() / points_;
  const Real error = 64 * kDouble * (all + displaced * displaced);
  const Range square = not_negative(around(least, error));
  return single_scalar(std::sqrt(least),
                       not_negative({std::sqrt(square.low) - displaced, std::sqrt(square.high) + displaced}));
}

}  // namespace pointsweep::formulas
