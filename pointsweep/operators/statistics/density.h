// SPDX-License-Identifier: MIT
/// The number of points around a point, per area of a plane through it and per volume.
#pragma once

#include <string>

#include "pointsweep/operator.h"
#include "pointsweep/operators.h"

namespace pointsweep {

/// Makes "surface_density" m / (π R²), points for each unit of area if the points lie on a plane through the point, as
/// a fitted plane cuts a disc of radius R out of the ball; and "volume_density" m / (4/3 π R³). N f32 each.
///   Without a radius: R is the distance to the farthest neighbour and m = |N_i|; the point itself is not counted.
///   With a radius: R is the radius, m the number of points within it, inclusive, the point itself counted, as in
///   CloudCompare.
/// Positions are the current ones. Without a radius, both densities are 0 and the point counts as degenerate if R is 0,
/// there is no neighbour, or a neighbour has no finite place.
class Density final : public LocalOperator {
 public:
  /// Throws UsageError for options out of their ranges.
  explicit Density(const DensityOptions& options = {});
  std::string name() const override { return "density"; }
  Contract contract() const override;
  void apply(const Neighborhoods& in, Columns& out) const override;

 private:
  DensityOptions options_;
};

}  // namespace pointsweep
