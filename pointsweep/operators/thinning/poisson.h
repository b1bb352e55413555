// SPDX-License-Identifier: MIT
/// Keeping points that are farther from each other than a radius.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators.h"

namespace pointsweep {

/// Takes the points in ascending order of the hash of their coordinates, equal hashes by x, y, z, then row. A point is
/// kept unless a kept point lies within the point's own radius. So every dropped point has a kept point within its
/// radius, and the later of two kept points is farther from the other than its own radius. Points without a finite
/// place are all kept.
class Poisson final : public InOrderOperator {
 public:
  /// Throws UsageError for options out of their ranges, and if the square of the radius cannot be represented.
  explicit Poisson(PoissonOptions options);
  std::string name() const override { return "poisson"; }
  InOrderContract in_order_contract() const override;
  std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const override;
  std::optional<Reach> reach() const override;
  /// Returns the memory for the points that are undecided at a time (undecided_points.h): all points less than a radius
  /// behind the newest point along the axis, and the points that wait for one of them.
  std::uint64_t least_bytes(const CloudEstimate& cloud) const override;
  /// Throws UsageError if radius_from does not name a single value of each point.
  std::shared_ptr<const InOrderOperator> bound(const Schema& input, std::span<const Attribute> made) const override;

 private:
  PoissonOptions options_;
  std::vector<Attribute> reads_;  ///< the attribute that radius_from names; empty without one
  std::size_t component_ = 0;     ///< component of the attribute
};

/// Seed of the hashes that give the order in which points are chosen.
inline constexpr std::uint64_t kPoissonSeed = 0x706f6973736f6e;

}  // namespace pointsweep
