// SPDX-License-Identifier: MIT
/// The diagonal of a cloud, for options in % of it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pointsweep/operator.h"

namespace pointsweep {

/// Computes one value, the diagonal of the box around the finite input points that earlier stages keep; 0 if none.
class InputDiagonal final : public Reduction {
 public:
  std::string text() const override { return "diagonal of the input"; }
  std::vector<Attribute> reads() const override { return {position_attribute()}; }
  bool of_input() const override { return true; }
  std::unique_ptr<Accumulator> start() const override;
};

}  // namespace pointsweep
