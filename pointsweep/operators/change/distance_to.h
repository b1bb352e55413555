// SPDX-License-Identifier: MIT
/// Distances from one cloud to another.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration distance_to_declaration();

/// Makes cloud_distance: the distance to the nearest point of another cloud, sqrt((dx² + dy²) + dz²) in float64.
class DistanceTo final : public InOrderOperator {
 public:
  /// Throws UsageError for options outside of their ranges.
  explicit DistanceTo(DistanceToOptions options);

  std::string name() const override { return "distance_to"; }
  InOrderContract in_order_contract() const override;
  std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const override;
  std::optional<Reach> reach() const override { return Reach{}; }
  std::optional<Reach> other_reach() const override;
  std::string other_cloud() const override { return options_.cloud; }
  std::uint64_t least_bytes(const CloudEstimate& cloud) const override;

 private:
  DistanceToOptions options_;
};

}  // namespace pointsweep
