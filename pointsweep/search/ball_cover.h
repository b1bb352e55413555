// SPDX-License-Identifier: MIT
/// Union of many balls, in cells of grids.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/search/ball_grid.h"

namespace pointsweep {

/// The cells of half to all of the width of a ball that it may touch are marked, at most 64. So a query costs the same
/// however many balls overlap: one look-up for each size of balls, about 10 ns. Thread-safe.
class BallCover {
 public:
  explicit BallCover(std::span<const Ball> balls);

  /// Returns true for every point of a ball, and for some points that are no farther from a ball than its width along
  /// each axis.
  bool covers(Vec3 p) const;

 private:
  void mark(std::uint64_t key);
  std::size_t find(std::uint64_t key) const;

  std::vector<BallGrid> grids_;
  std::vector<std::uint64_t> marked_;  ///< open addressing; 0: free. The size is a power of two
  std::size_t count_ = 0;
  bool is_unbounded_ = false;
};

}  // namespace pointsweep
