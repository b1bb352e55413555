// SPDX-License-Identifier: MIT
/// Neighbourhoods whose k or radius is an attribute of the point.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/neighborhood.h"
#include "pointsweep/operators.h"

namespace pointsweep {

/// Keeps the neighbours that both limits allow. NaN, a negative value or a k below 1 allows none: operators count a
/// point without neighbours as degenerate. A value above the limits of the search allows all neighbours found. A radius
/// of 0 keeps the neighbours that coincide with the point. A neighbour is within the radius if ((dx² + dy²) + dz²) <=
/// radius · radius in double, as for the radius of `knn`. So `neighbor_radius`, the rounded root of a squared distance,
/// may be too small by one unit in the last place to include the farthest neighbour, from which it comes.
class LimitsFromAttributes final : public NeighborhoodRule {
 public:
  /// Throws UsageError if `limits` names no attribute.
  explicit LimitsFromAttributes(AttributeLimits limits);
  std::string meaning() const override;
  std::vector<Attribute> reads() const override;
  Options options() const override;
  void choose(const Neighborhoods& in, std::span<std::uint32_t> counts) const override;

 private:
  AttributeLimits limits_;
};

}  // namespace pointsweep
