// SPDX-License-Identifier: MIT
/// The residual of a component: the distance of its points from a plane.
#pragma once

#include <cstddef>

#include "pointsweep/connect/vote_rule.h"

namespace pointsweep {

/// The root mean square distance to the plane that makes it least: the square root of the least eigenvalue of the
/// covariance of the points. Positions count to 2^-40, at most 2^40 in absolute value, so that sums are exact integers;
/// from the sums on it is float64, which knows an eigenvalue to about 2^-50 of the largest, then float32. So the error
/// is below 10^-7 of the extent of the component, or 2^-40 where that is more. Fewer than four points are in a plane:
/// 0.
class PlaneResidual final : public VoteRule {
 public:
  /// `moved`: a ballot is a position, three float64; otherwise the position of the search counts and ballots are empty.
  explicit PlaneResidual(bool moved) : moved_(moved) {}
  std::size_t ballot_bytes() const override { return moved_ ? 3 * sizeof(double) : 0; }
  std::size_t bytes() const override;
  void start(std::byte* votes, const PointKey& point, const std::byte* ballot) const override;
  void merge(std::byte* into, const std::byte* from, bool flips) const override;
  /// Size of the result: one float32, NaN where a point has no finite place.
  std::size_t result_bytes() const override { return sizeof(float); }
  void conclude(const std::byte* votes, std::byte* result) const override;

 private:
  bool moved_;
};

}  // namespace pointsweep
