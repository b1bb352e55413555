// SPDX-License-Identifier: MIT
/// The box around the finite points of a cloud.
#pragma once

#include "pointsweep/math/box.h"
#include "pointsweep/operator.h"
#include "pointsweep/storage/encoding.h"

namespace pointsweep {

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

}  // namespace pointsweep
