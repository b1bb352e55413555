// SPDX-License-Identifier: MIT
/// Look-up of the balls that contain a point, the union of many balls, and the cells of a box that balls touch. Balls
/// may have very different sizes: look-up and union have, for each power of two, a grid of cells for balls of about
/// that size.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/math/mix.h"

namespace pointsweep {

/// Set of the points within sqrt(reach2) of a place, by distance2() in double.
struct Ball {
  Vec3 center;
  double reach2;
};

/// Returns a distance from the centre that no point of the ball exceeds along an axis, in spite of the rounding of
/// squares.
inline double safe_radius(double reach2) { return std::sqrt(reach2) * (1 + 1e-12) + 1e-150; }

/// Balls with a larger radius belong to no grid.
inline constexpr double kLargestRadius = 1e150;

/// A grid of cubic cells for balls of about one size.
struct BallGrid {
  int exponent;  ///< cells are 2^exponent wide
  double scale;  ///< 2^-exponent
  Box bounds;    ///< box of the balls

  /// Returns the number of a cell along an axis. If the grid is finer than the spacing of doubles, adjacent coordinates
  /// have numbers that are adjacent doubles.
  double cell_of(double coordinate) const { return std::floor(coordinate * scale); }
  /// Returns the key of a cell, which is never 0. Two cells may share a key.
  std::uint64_t key_of(double x, double y, double z) const {
    const auto bits = [](double c) { return std::bit_cast<std::uint64_t>(c + 0.0); };  // -0 is 0
    return mix(bits(x) * 0x9e3779b97f4a7c15u + bits(y) * 0xc2b2ae3d27d4eb4fu + bits(z) * 0x165667b19e3779f9u +
               static_cast<std::uint64_t>(exponent)) |
           1;
  }
  std::uint64_t key_at(Vec3 p) const { return key_of(cell_of(p.x), cell_of(p.y), cell_of(p.z)); }
};

/// Returns the grid of `exponent`; adds the grid if it is missing.
inline BallGrid& grid_with(int exponent, std::vector<BallGrid>& grids) {
  for (BallGrid& grid : grids)
    if (grid.exponent == exponent) return grid;
  return grids.emplace_back(BallGrid{exponent, std::ldexp(1.0, -exponent), {}});
}

/// A look-up of the balls that contain a point. Balls of similar size share a grid whose cells are at least twice as
/// wide as the balls, so that each ball touches at most eight cells. A query looks up one cell of each grid, in about
/// 10 ns per grid. Queries are thread-safe.
class BallLookup {
 public:
  explicit BallLookup(std::span<const Ball> balls);

  /// Calls use(i) once for every ball i that holds `p`, and for some other balls.
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
    std::uint64_t key = 0;  ///< key of the cell; 0 for a free bucket
    std::uint32_t first = 0, count = 0;
  };
  std::size_t find(std::uint64_t key) const;

  std::vector<BallGrid> grids_;
  std::vector<Bucket> buckets_;  ///< open addressing; the size is a power of two
  std::vector<std::uint32_t> numbers_, unbounded_;
};

/// The union of many balls. Each ball marks the cells that it may touch, at most 64; a cell has half to the whole width
/// of the ball. A query takes one look-up in each grid, about 10 ns, for any number of overlapping balls. Queries are
/// thread-safe.
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

/// A box divided into cells, with a mark on each cell that a ball touches. If most points of the box lie in no ball, a
/// test of the cell of a point, about 2 ns, saves the look-up of the balls around the point. Queries are thread-safe.
class BallRaster {
 public:
  BallRaster(const Box& box, std::span<const Ball> balls);

  /// Returns false only for points of the box that lie in no ball.
  bool may_hold(Vec3 p) const {
    return marked_[(cell_of(0, p.x) * cells_[1] + cell_of(1, p.y)) * cells_[2] + cell_of(2, p.z)] != 0;
  }

 private:
  /// Returns the number of the cell along an axis, which does not decrease as the coordinate grows.
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
