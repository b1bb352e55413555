// SPDX-License-Identifier: MIT
/// Distances from one cloud to another.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "pointsweep/in_order_operator.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration distance_to_declaration();

/// Makes cloud_distance: the distance to the nearest point of another cloud, sqrt((dx² + dy²) + dz²) in float64.
class DistanceTo final : public InOrderOperator {
 public:
  /// Throws UsageError unless `most` is above 0 and `cloud` not empty.
  DistanceTo(std::string cloud, double most);

  std::string name() const override { return "distance_to"; }
  InOrderContract in_order_contract() const override;
  std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const override;
  std::string other_cloud() const override { return cloud_; }
  std::uint64_t least_bytes(const CloudEstimate& cloud) const override;

 protected:
  Options own_options() const override;

 private:
  std::string cloud_;
  double most_;
};

}  // namespace pointsweep
