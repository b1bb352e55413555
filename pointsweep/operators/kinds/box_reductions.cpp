// SPDX-License-Identifier: MIT
#include "pointsweep/operators/kinds/box_reductions.h"

#include "pointsweep/storage/encoding.h"

namespace pointsweep {
namespace {

/// Finds the box around all finite points; finish() of a derived class converts the box to values.
class BoxAccumulator : public Accumulator {
 public:
  void add(const double* values, std::size_t points) override {
    for (std::size_t i = 0; i < points; ++i, values += 3) {
      const Vec3 p{values[0], values[1], values[2]};
      if (is_finite(p)) box_.include(p);
    }
  }
  void merge(const Accumulator& other) override { box_.include(static_cast<const BoxAccumulator&>(other).box_); }
  std::vector<std::byte> save() const override {
    Encoder out;
    out.begin(kEncoding);
    out.put_box(box_);
    return out.take();
  }
  void load(std::span<const std::byte> bytes) override {
    Decoder in(bytes);
    in.begin(kEncoding);
    const Box box = in.get_box();
    in.finish();
    box_.include(box);
  }

 protected:
  static constexpr Encoding kEncoding{"box of points", 1};
  Box box_;
};

class Diagonal final : public BoxAccumulator {
 public:
  std::vector<double> finish() const override { return {box_.empty() ? 0 : box_.diagonal()}; }
};

class SixNumbers final : public BoxAccumulator {
 public:
  /// Adding 0 turns -0, which equals 0, into 0, so that the bits do not depend on the number of threads.
  std::vector<double> finish() const override {
    const Vec3 &lo = box_.lo, &hi = box_.hi;
    return {lo.x + 0.0, lo.y + 0.0, lo.z + 0.0, hi.x + 0.0, hi.y + 0.0, hi.z + 0.0};
  }
};

}  // namespace

std::unique_ptr<Accumulator> InputDiagonal::start() const { return std::make_unique<Diagonal>(); }

std::unique_ptr<Accumulator> MovedBounds::start() const { return std::make_unique<SixNumbers>(); }

Box box_of(std::span<const double> moved_bounds) {
  Box box;
  box.lo = {moved_bounds[0], moved_bounds[1], moved_bounds[2]};
  box.hi = {moved_bounds[3], moved_bounds[4], moved_bounds[5]};
  return box;
}

}  // namespace pointsweep
