// SPDX-License-Identifier: MIT
#include "pointsweep/operators/kinds/input_diagonal.h"

#include "pointsweep/operators/kinds/box_accumulator.h"

namespace pointsweep {
namespace {

class Diagonal final : public BoxAccumulator {
 public:
  std::vector<double> finish() const override { return {box_.empty() ? 0 : box_.diagonal()}; }
};

}  // namespace

std::unique_ptr<Accumulator> InputDiagonal::start() const { return std::make_unique<Diagonal>(); }

}  // namespace pointsweep
