// SPDX-License-Identifier: MIT
/// Reductions to the box around the finite points of a cloud: its diagonal, and the bounds of moved points.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/operator.h"

namespace pointsweep {

/// Computes one value, the diagonal of the box around the finite input points that earlier stages keep, for options in
/// percent of the diagonal. The value is 0 if there is no such point.
class InputDiagonal final : public Reduction {
 public:
  std::string text() const override { return "diagonal of the input"; }
  std::vector<Attribute> reads() const override { return {position_attribute()}; }
  bool of_input() const override { return true; }
  std::unique_ptr<Accumulator> start() const override;
};

/// Computes the box of the positions after all stages that move points. An output that stores integers needs this box.
class MovedBounds final : public Reduction {
 public:
  std::string text() const override { return "bounds of moved points"; }
  std::vector<Attribute> reads() const override { return {position_attribute()}; }
  std::unique_ptr<Accumulator> start() const override;
};

/// Returns the box in the value of a MovedBounds; empty if no point is finite.
Box box_of(std::span<const double> moved_bounds);

}  // namespace pointsweep
