// SPDX-License-Identifier: MIT
/// Neighbourhoods whose k or radius is an attribute of the point.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/neighborhood.h"
#include "pointsweep/operators.h"

namespace pointsweep {

/// Keeps the neighbours that both limits allow. A value that is NaN or negative, and a k below 1, allow none: the point
/// has no neighbours, which operators count as degenerate. A value above what the search was asked for allows all that
/// it found. A radius of 0 keeps the points in the same place. Within means, in double, d² = ((dx² + dy²) + dz²)
/// <= radius², as for a radius for all points, or √d² <= radius: the attribute `neighbor_radius` holds the rounded
/// root, whose square can be less than d². An attribute of float32 is not adjusted: a distance that was rounded down
/// to float32 excludes the farthest neighbour.
class LimitsFromAttributes final : public NeighborhoodRule {
 public:
  /// Throws UsageError where neither attribute is named.
  explicit LimitsFromAttributes(AttributeLimits limits);
  std::string meaning() const override;
  std::vector<Attribute> reads() const override;
  Options options() const override;
  void choose(const Neighborhoods& in, std::span<std::uint32_t> counts) const override;
  const AttributeLimits& limits() const { return limits_; }

 private:
  AttributeLimits limits_;
};

}  // namespace pointsweep
