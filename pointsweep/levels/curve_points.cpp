// SPDX-License-Identifier: MIT
#include "pointsweep/levels/curve_points.h"

namespace pointsweep {

void CurvePoints::add(std::span<const std::byte> records, std::size_t record_bytes) {
  const std::size_t rows = records.size() / record_bytes;
  added_.resize(rows);
  for (std::size_t i = 0; i < rows; ++i) {
    added_[i] = point_of(&records[i * record_bytes]);
    if ((count_ + i) % kBlockRows == 0) bounds_.push_back({added_[i], added_[i]});
    bounds_.back().include(added_[i]);
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
