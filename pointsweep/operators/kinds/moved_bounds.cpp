// SPDX-License-Identifier: MIT
#include "pointsweep/operators/kinds/moved_bounds.h"

#include "pointsweep/operators/kinds/box_accumulator.h"

namespace pointsweep {
namespace {

class SixNumbers final : public BoxAccumulator {
 public:
  /// Adding 0 turns -0, which equals 0, into 0, so that the bits do not depend on the number of threads.
  std::vector<double> finish() const override {
    const Vec3 &lo = box_.lo, &hi = box_.hi;
    return {lo.x + 0.0, lo.y + 0.0, lo.z + 0.0, hi.x + 0.0, hi.y + 0.0, hi.z + 0.0};
  }
};

}  // namespace

std::unique_ptr<Accumulator> MovedBounds::start() const { return std::make_unique<SixNumbers>(); }

Box box_of(std::span<const double> moved_bounds) {
  Box box;
  box.lo = {moved_bounds[0], moved_bounds[1], moved_bounds[2]};
  box.hi = {moved_bounds[3], moved_bounds[4], moved_bounds[5]};
  return box;
}

}  // namespace pointsweep
