// SPDX-License-Identifier: MIT
/// The size of a cloud, in which widths of operators are given.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pointsweep/operator.h"

namespace pointsweep {

/// {diagonal} of the box around all finite points of the input that are left; 0 without any.
class InputDiagonal final : public Reduction {
 public:
  std::string text() const override { return "diagonal of the input"; }
  std::vector<Attribute> reads() const override { return {position_attribute()}; }
  bool of_input() const override { return true; }
  std::unique_ptr<Accumulator> start() const override;
};

}  // namespace pointsweep
