// SPDX-License-Identifier: MIT
/// The choice between the two consistent orientations of the normals of a component (connected points of a graph).
#pragma once

#include <cstddef>
#include <optional>

#include "pointsweep/connect/vote_rule.h"
#include "pointsweep/geometry.h"

namespace pointsweep {

/// Decides the signs of a component by votes of all its points, so that the noise of a single normal does not decide.
/// Normals n count in steps of 2^-20 and positions p in steps of 2^-32, up to 2^40 in magnitude, so that sums over the
/// points are exact integers. With signs s and the centroid c of the component:
///   up  = Σ s n_z
///   out = Σ s n · (p - c) / e, e the mean extent of the component: positive if normals point out of a closed surface
/// The sum with the larger absolute value must be positive. With a viewpoint v, the sum is Σ sign(s n · (v - p))
/// instead. If the sum is 0, the normal of the highest point must point up (Hoppe et al. 1992); if that normal is
/// horizontal, the first point keeps its normal.
class OrientationVotes final : public VoteRule {
 public:
  explicit OrientationVotes(std::optional<Vec3> viewpoint) : viewpoint_(viewpoint) {}
  /// A ballot is a normal, three float32.
  std::size_t ballot_bytes() const override { return 3 * sizeof(float); }
  std::size_t bytes() const override;
  void start(std::byte* votes, const PointKey& point, const std::byte* ballot) const override;
  void merge(std::byte* into, const std::byte* from, bool flips) const override;
  /// Returns the size of the result: one byte, not 0 if the signs must be flipped.
  std::size_t result_bytes() const override { return 1; }
  void conclude(const std::byte* votes, std::byte* result) const override;
  bool turns(const std::byte* result) const override { return *result != std::byte{0}; }

 private:
  std::optional<Vec3> viewpoint_;
};

}  // namespace pointsweep
