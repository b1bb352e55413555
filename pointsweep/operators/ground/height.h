// SPDX-License-Identifier: MIT
/// Height above the ground: above the nearest points of the ground in the plane.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pointsweep/in_order_operator.h"
#include "pointsweep/operators.h"

namespace pointsweep {

/// Returns height, N f64, in length units: z above the ground; NaN if the cloud has no ground.
Attribute height_attribute();

/// Makes height: z - Σ w_j z_j / Σ w_j over the k points of class 2 that are nearest in x and y, w_j = 1 / d_j², summed
/// nearest first; if the nearest has d = 0, it is z - z_1. Equal distances are ordered by x, y, z, row. All ground
/// points of the cloud are searched, however far away.
class Height final : public InOrderOperator {
 public:
  /// Throws UsageError for options outside of their ranges.
  explicit Height(const HeightOptions& options = {});
  std::string name() const override { return "height"; }
  InOrderContract in_order_contract() const override;
  std::shared_ptr<const InOrderOperator> bound(const Schema& input, std::span<const Attribute> made) const override;
  Vec3 place_of(Vec3 position) const override { return {position.x, position.y, 0}; }
  std::unique_ptr<InOrderWork> start(const InOrderSetup& setup) const override;
  std::optional<Reach> reach() const override;
  ChoosePoints for_other_parts() const override;
  std::uint64_t least_bytes(const CloudEstimate& cloud) const override;

 private:
  HeightOptions options_;
  Attribute class_;
};

}  // namespace pointsweep
