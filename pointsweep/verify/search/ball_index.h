// SPDX-License-Identifier: MIT
/// An index of many balls that finds the balls in which a point may lie.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// Regular grids, each with cells half as wide as the one before. A ball is listed in the cells that it touches of the
/// finest grid whose cells are at least as wide as the ball, so in at most 8. A query visits one cell of each grid that
/// lists a ball. Cells are hashed, so a query may also visit balls that are far away, but it visits every ball that
/// contains the point exactly once.
class BallIndex {
 public:
  /// Indexes balls around `centers` with squared radii `reach2`, which may be infinite. Balls are numbered from 0;
  /// there are fewer than 2^28.
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
    double per_length = 0;             ///< number of cells per unit of length
    double last = 0;                   ///< greatest number of a cell; points beyond are in that cell
    std::uint32_t mask = 0;            ///< number of buckets - 1
    std::vector<std::uint32_t> begin;  ///< first entry of each bucket in `balls`
    std::vector<std::uint32_t> balls;

    Cell cell(Vec3 p, Vec3 low) const { return {along(p.x, low.x), along(p.y, low.y), along(p.z, low.z)}; }
    /// Returns the number of the cell along an axis. It never descends as `value` ascends, so the cells of a ball form
    /// a range.
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
