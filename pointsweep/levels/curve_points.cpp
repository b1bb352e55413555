// SPDX-License-Identifier: MIT
#include "pointsweep/levels/curve_points.h"

#include <algorithm>
#include <cstring>

namespace pointsweep {

void CurvePoints::add(std::span<const std::byte> records, std::size_t record_bytes) {
  const std::size_t rows = records.size() / record_bytes;
  added_.resize(rows);
  for (std::size_t i = 0; i < rows; ++i) {
    GridPoint& point = added_[i];
    std::memcpy(point.data(), &records[i * record_bytes], sizeof point);
    if ((count_ + i) % kBlockRows == 0) bounds_.push_back({point, point});
    GridBounds& bounds = bounds_.back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      bounds.lo[axis] = std::min(bounds.lo[axis], point[axis]);
      bounds.hi[axis] = std::max(bounds.hi[axis], point[axis]);
    }
  }
  scratch_->append(std::as_bytes(std::span(added_)));
  count_ += rows;
}

void CurvePoints::read(std::uint64_t first, std::span<GridPoint> points) const {
  scratch_->read(first * sizeof(GridPoint), std::as_writable_bytes(points));
}

Box CurvePoints::block_box(std::uint64_t block) const {
  const GridBounds& bounds = bounds_[static_cast<std::size_t>(block)];
  return {grid_.place(bounds.lo), grid_.place(bounds.hi)};
}

}  // namespace pointsweep
