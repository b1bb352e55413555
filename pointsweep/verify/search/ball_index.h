// SPDX-License-Identifier: MIT
/// An index of many balls that finds the balls in which a point may lie.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// Regular grids whose cells halve from one to the next; a ball is listed in the cells it touches of the finest grid
/// whose cells are as wide as the ball, so in 8 at most, and a point is asked for in one cell of each grid that lists a
/// ball. Cells are hashed, hence a point may be shown balls that are far away, but every ball it lies in once.
class BallIndex {
 public:
  /// Balls around `centers` with squared radii `reach2`, which may be infinite. Balls are numbered from 0 and fewer
  /// than 2^28.
  BallIndex(const std::vector<Vec3>& centers, const std::vector<double>& reach2);

  /// Calls use(ball) for each ball with distance2(center, p) <= reach2, and for some others.
  template <class Use>
  void visit(Vec3 p, Use use) const {
    for (const Grid& grid : grids_) {
      const std::uint32_t bucket = grid.bucket(grid.cell(p, low_));
      for (std::uint32_t i = grid.begin[bucket]; i < grid.begin[bucket + 1]; ++i) use(grid.balls[i]);
    }
  }

 private:
  using Cell = std::array<std::uint32_t, 3>;

  struct Grid {
    double per_length = 0;             ///< cells per unit of length
    double last = 0;                   ///< greatest number of a cell; what lies beyond is there too
    std::uint32_t mask = 0;            ///< number of buckets - 1
    std::vector<std::uint32_t> begin;  ///< by bucket, into balls
    std::vector<std::uint32_t> balls;

    Cell cell(Vec3 p, Vec3 low) const { return {along(p.x, low.x), along(p.y, low.y), along(p.z, low.z)}; }
    /// Never descends with `value`, so a cell between two others is found between them.
    std::uint32_t along(double value, double low) const {
      const double t = (value - low) * per_length;
      return t > 0 ? static_cast<std::uint32_t>(t < last ? t : last) : 0;
    }
    std::uint32_t bucket(Cell c) const {
      std::uint64_t h = c[0] * std::uint64_t{0x9e3779b97f4a7c15} + c[1] * std::uint64_t{0xc2b2ae3d27d4eb4f} +
                        c[2] * std::uint64_t{0x165667b19e3779f9};
      h ^= h >> 32;
      return static_cast<std::uint32_t>((h * std::uint64_t{0xd6e8feb86659fd93}) >> 32) & mask;
    }
  };

  void fill(Grid& grid, const std::vector<std::uint32_t>& members, const std::vector<Vec3>& centers,
            const std::vector<double>& radius) const;

  Vec3 low_;
  std::vector<Grid> grids_;
};

}  // namespace pointsweep
