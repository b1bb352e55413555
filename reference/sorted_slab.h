// SPDX-License-Identifier: MIT
/// A slab of the ordered stream, sorted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pointsweep/order/stream.h"

namespace pointsweep::reference {

/// The points of one slab in canonical order. Place 0 is the first point of the slab.
class SortedSlab {
 public:
  void load(const Stream& stream, std::size_t slab);

  std::size_t size() const { return order_.size(); }
  Vec3 position(std::size_t place) const { return {x_[order_[place]], y_[order_[place]], z_[order_[place]]}; }
  std::uint64_t row(std::size_t place) const { return row_[order_[place]]; }
  const std::byte* record(std::size_t place) const { return records_.data() + std::size_t{order_[place]} * stride_; }

 private:
  std::size_t stride_ = 0;
  std::vector<std::byte> records_;
  std::vector<double> x_, y_, z_;
  std::vector<std::uint64_t> row_;
  std::vector<std::uint32_t> order_;
};

}  // namespace pointsweep::reference
