// SPDX-License-Identifier: MIT
/// The choice of the right one of the two consistent orientations of a component of a surface.
#pragma once

#include <cstddef>
#include <optional>

#include "pointsweep/connect/vote_rule.h"
#include "pointsweep/geometry.h"

namespace pointsweep {

/// Every point of a component votes, so that the noise of no single normal decides. With signs s, normals n (to 2^-20),
/// positions p (to 2^-32, absolute, at most 2^40) and the centroid c of the component, sums are exact integers:
///   up  = Σ s n_z
///   out = Σ s n · (p - c) / e, e the mean extent of the component: positive where normals point out of a closed
///   surface
/// The larger absolute value of the two decides. With a viewpoint v: Σ sign(s n · (v - p)). Where that is 0, the
/// highest point decides, whose normal points up (Hoppe et al. 1992), or is level and leaves it to the first point.
class OrientationVotes final : public VoteRule {
 public:
  explicit OrientationVotes(std::optional<Vec3> viewpoint) : viewpoint_(viewpoint) {}
  /// A ballot is a normal, three float32.
  std::size_t ballot_bytes() const override { return 3 * sizeof(float); }
  std::size_t bytes() const override;
  void start(std::byte* votes, const PointKey& point, const std::byte* ballot) const override;
  void merge(std::byte* into, const std::byte* from, bool flips) const override;
  /// Size of the result: one byte, not 0 if the signs are to be turned.
  std::size_t result_bytes() const override { return 1; }
  void conclude(const std::byte* votes, std::byte* result) const override;
  bool turns(const std::byte* result) const override { return *result != std::byte{0}; }

 private:
  std::optional<Vec3> viewpoint_;
};

}  // namespace pointsweep
