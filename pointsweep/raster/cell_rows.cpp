// SPDX-License-Identifier: MIT
#include "pointsweep/raster/cell_rows.h"

namespace pointsweep {

void SurfaceWindow::move_to(std::uint64_t row) {
  while (!ended_ && first_ + rows_ <= row + around_) {
    ended_ = !from_->next(block_);
    values_.insert(values_.end(), block_.values.begin(), block_.values.end());
    rows_ += block_.rows;
    const std::uint64_t keep = row < around_ ? 0 : row - around_;
    if (keep <= first_) continue;
    const std::size_t old = std::min<std::size_t>(rows_, static_cast<std::size_t>(keep - first_));
    values_.erase(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(old * from_->columns()));
    first_ += old;
    rows_ -= old;
  }
}

}  // namespace pointsweep
