// SPDX-License-Identifier: MIT
/// Look-up of the balls that hold a point, for balls of very different sizes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/search/ball_grid.h"

namespace pointsweep {

/// Balls of similar size share a grid whose cells are at least twice as wide, so that each ball lies in eight cells at
/// most. A query looks one cell up for each size: about 10 ns. Thread-safe.
class BallLookup {
 public:
  explicit BallLookup(std::span<const Ball> balls);

  /// Calls use(i) for every ball i that holds `p`, each once, and for some of the others.
  template <class Use>
  void for_each_near(Vec3 p, Use use) const {
    for (const std::uint32_t number : unbounded_) use(number);
    for (const BallGrid& grid : grids_) {
      if (distance2(grid.bounds, p) > 0) continue;
      const Bucket& bucket = buckets_[find(grid.key_at(p))];
      for (std::uint32_t i = bucket.first; i < bucket.first + bucket.count; ++i) use(numbers_[i]);
    }
  }

 private:
  struct Bucket {
    std::uint64_t key = 0;  ///< 0: empty
    std::uint32_t first = 0, count = 0;
  };
  std::size_t find(std::uint64_t key) const;

  std::vector<BallGrid> grids_;
  std::vector<Bucket> buckets_;  ///< open addressing; the size is a power of two
  std::vector<std::uint32_t> numbers_, unbounded_;
};

}  // namespace pointsweep
