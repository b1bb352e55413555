// SPDX-License-Identifier: MIT
/// Neighbourhoods whose k or radius is an attribute of the point.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/neighborhood.h"
#include "pointsweep/operators.h"

namespace pointsweep {

/// Keeps the neighbours that both limits allow. A value that is NaN or negative, and a k below 1, allow none: the point
/// has no neighbours, which operators count as degenerate. A value above the limits of the search allows all neighbours
/// found. A radius of 0 keeps the points in the same place. A neighbour is within the radius if ((dx² + dy²) + dz²) <=
/// radius · radius in double, as for a radius of all points. So `neighbor_radius`, the rounded root of a squared
/// distance, may be too small by one unit in the last place to include its own neighbour.
class LimitsFromAttributes final : public NeighborhoodRule {
 public:
  /// Throws UsageError where neither attribute is named.
  explicit LimitsFromAttributes(AttributeLimits limits);
  std::string meaning() const override;
  std::vector<Attribute> reads() const override;
  Options options() const override;
  void choose(const Neighborhoods& in, std::span<std::uint32_t> counts) const override;

 private:
  AttributeLimits limits_;
};

}  // namespace pointsweep
