// SPDX-License-Identifier: MIT
/// A coarse picture of where some balls lie in a box.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/search/ball_lookup.h"

namespace pointsweep {

/// The cells of a box that balls touch. If most points of the box lie in no ball, a test of the cell of a point, about
/// 2 ns, saves the look-up of the balls around the point. Thread-safe.
class BallRaster {
 public:
  BallRaster(const Box& box, std::span<const Ball> balls);

  /// Returns false only for points of the box that lie in no ball.
  bool may_hold(Vec3 p) const {
    return marked_[(cell_of(0, p.x) * cells_[1] + cell_of(1, p.y)) * cells_[2] + cell_of(2, p.z)] != 0;
  }

 private:
  /// Returns the cell along an axis, which does not decrease as the coordinate grows.
  std::size_t cell_of(int axis, double coordinate) const {
    const double cell = (coordinate - lo_[axis]) * scale_[axis];
    return cell > 0 ? std::min(static_cast<std::size_t>(std::min(cell, kMostCells)), cells_[axis] - 1) : 0;
  }
  void divide(Vec3 extent);

  static constexpr double kMostCells = 1 << 17;

  Vec3 lo_;
  std::array<double, 3> scale_{};  ///< number of cells per unit of length along each axis
  std::array<std::size_t, 3> cells_{1, 1, 1};
  std::vector<std::uint8_t> marked_;
};

}  // namespace pointsweep
