// SPDX-License-Identifier: MIT
#include "pointsweep/operators/input_diagonal.h"

#include "pointsweep/math/box.h"

namespace pointsweep {
namespace {

class Bounds final : public Accumulator {
 public:
  void add(const double* values, std::size_t points) override {
    for (std::size_t i = 0; i < points; ++i, values += 3) {
      const Vec3 p{values[0], values[1], values[2]};
      if (is_finite(p)) box_.include(p);
    }
  }
  void merge(const Accumulator& other) override {
    const Box& box = static_cast<const Bounds&>(other).box_;
    if (!box.empty()) box_.include(box.lo), box_.include(box.hi);
  }
  std::vector<double> finish() const override { return {box_.empty() ? 0 : box_.diagonal()}; }

 private:
  Box box_;
};

}  // namespace

std::unique_ptr<Accumulator> InputDiagonal::start() const { return std::make_unique<Bounds>(); }

}  // namespace pointsweep
