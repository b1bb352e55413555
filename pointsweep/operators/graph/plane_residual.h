// SPDX-License-Identifier: MIT
/// The residual of a component (connected points of a graph): the distance of its points from their best plane.
#pragma once

#include <cstddef>

#include "pointsweep/connect/vote_rule.h"

namespace pointsweep {

/// The root mean square distance of points to their best plane: the square root of the least eigenvalue of their
/// covariance. Positions are rounded to 2^-40, at most 2^40 in absolute value, so that sums are exact integers. Later
/// steps are in float64, which determines an eigenvalue to about 2^-50 of the largest, and the result is float32. So
/// the error is below 10^-7 of the extent of the component, or 2^-40 if that is more. The residual of fewer than four
/// points is 0.
class PlaneResidual final : public VoteRule {
 public:
  /// `moved`: true if a ballot is the moved position of a point, three float64. Otherwise ballots are empty, and the
  /// position in the key of the point counts.
  explicit PlaneResidual(bool moved) : moved_(moved) {}
  std::size_t ballot_bytes() const override { return moved_ ? 3 * sizeof(double) : 0; }
  std::size_t bytes() const override;
  void start(std::byte* votes, const PointKey& point, const std::byte* ballot) const override;
  void merge(std::byte* into, const std::byte* from, bool flips) const override;
  /// Returns the size of the result: one float32, NaN if a point has no finite place.
  std::size_t result_bytes() const override { return sizeof(float); }
  void conclude(const std::byte* votes, std::byte* result) const override;

 private:
  bool moved_;
};

}  // namespace pointsweep
