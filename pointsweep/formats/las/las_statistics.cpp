// SPDX-License-Identifier: MIT
#include "pointsweep/formats/las/las_statistics.h"

#include <algorithm>
#include <cstring>

#include "pointsweep/formats/las/las_point_formats.h"

namespace pointsweep {

LasStatistics::LasStatistics(int point_format) : return_mask_(las_return_mask(point_format)) {}

void LasStatistics::add(const std::byte* records, std::size_t stride, std::size_t count) {
  auto lo = lo_, hi = hi_;
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* record = records + i * stride;
    std::array<std::int32_t, 3> p;
    std::memcpy(p.data(), record, sizeof p);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lo[axis] = std::min(lo[axis], p[axis]);
      hi[axis] = std::max(hi[axis], p[axis]);
    }
    ++by_return_[static_cast<std::uint8_t>(record[kLasReturnByte]) & return_mask_];
  }
  lo_ = lo;
  hi_ = hi;
  count_ += count;
}

void LasStatistics::add(const LasStatistics& other) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lo_[axis] = std::min(lo_[axis], other.lo_[axis]);
    hi_[axis] = std::max(hi_[axis], other.hi_[axis]);
  }
  for (std::size_t r = 0; r < by_return_.size(); ++r) by_return_[r] += other.by_return_[r];
  count_ += other.count_;
}

void LasStatistics::put_into(LasHeader& header) const {
  set_counts(header, count_, by_return_);
  header.bounds = {{0, 0, 0}, {0, 0, 0}};
  if (count_ == 0) return;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    header.bounds.lo[axis] = lo_[a] * header.scale[axis] + header.offset[axis];
    header.bounds.hi[axis] = hi_[a] * header.scale[axis] + header.offset[axis];
  }
}

}  // namespace pointsweep
