// SPDX-License-Identifier: MIT
/// Bounds of the points of a cloud after all stages that move points.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/operator.h"

namespace pointsweep {

/// The box of the moved positions, for planning an output that stores integers.
class MovedBounds final : public Reduction {
 public:
  std::string text() const override { return "bounds of moved points"; }
  std::vector<Attribute> reads() const override { return {position_attribute()}; }
  std::unique_ptr<Accumulator> start() const override;
};

/// Returns the box in the value of a MovedBounds; empty if no point is finite.
Box box_of(std::span<const double> moved_bounds);

}  // namespace pointsweep
