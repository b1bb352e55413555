// SPDX-License-Identifier: MIT
/// Density of points: the area that they cover, seen from above, and exact distances from some points to their
/// nearest neighbours.
#pragma once

#include <cstdint>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/math/box.h"

namespace pointsweep {

/// Counts the occupied cells of a square grid in x and y. If points lie at more than `limit` places, the side of a cell
/// is the smallest power of two, from 2^-40 on, for which the bounds of the points cover at most `limit` cells,
/// occupied or not. This side does not depend on the order of the points or their places within the bounds; with fewer
/// points in the same bounds the cells are as large or larger. Memory: 48 to 96 bytes × limit, and twice that while the
/// side is doubled.
class PlanArea {
 public:
  /// Sets `limit` to a sixteenth of `points`, at least 16 and at most 65,536. A cell of a cloud that fills its bounds
  /// holds about 16 to 64 points on average; more in clouds of more than 2^20 points, fewer in those of less than 256.
  explicit PlanArea(std::uint64_t points);

  /// Adds a point with finite coordinates.
  void add(double x, double y);
  /// Chooses the side of the cells. Must be called when all points have been added.
  void settle();

  double cell_side() const { return side_; }
  /// Returns the area in squared units of the coordinates; 0 if the points lie at no more places than `limit`.
  double area() const;

 private:
  struct Cell {
    std::int64_t x = 0, y = 0;
    bool taken = false;
  };
  Cell cell_of(double x, double y) const;
  bool insert(Cell cell);
  void coarsen();
  double cells_of_bounds() const;

  std::uint64_t limit_, count_ = 0;
  double lo_x_, hi_x_, lo_y_, hi_y_;
  double side_;
  bool has_area_ = false;  ///< true if the points lie at more places than the limit
  std::vector<Cell> table_;
  Cell last_;
};

/// A kd-tree over the sample, the points whose nearest neighbours are sought. Each sampled point has the distance to
/// its nearest neighbour so far, and each node the largest of these distances in its subtree, all squared. A point of
/// the cloud visits a node only if the box of the node is closer than the distance of the node. Memory is proportional
/// to the size of the sample.
class NearestDistances {
 public:
  struct Sampled {
    Vec3 position;  ///< finite
    std::uint64_t row;
  };
  explicit NearestDistances(std::vector<Sampled> sample);

  /// Takes a finite point of the cloud. A sampled point is not its own neighbour; other points at distance 0 are.
  void add(Vec3 position, std::uint64_t row);

  /// Returns the distances of all sampled points with a neighbour, ascending.
  std::vector<double> distances() const;

 private:
  struct Node {
    Box box;
    double farthest2;                 ///< largest of `nearest2_` in the subtree
    std::uint32_t begin, end, above;  ///< range in `sample_`; `above`: index of the second child, 0 in a leaf
  };
  void build(std::uint32_t begin, std::uint32_t end);
  void visit(std::uint32_t node, Vec3 position, std::uint64_t row);

  std::vector<Sampled> sample_;
  std::vector<double> nearest2_;  ///< for each sampled point, its squared distance to the nearest neighbour so far
  std::vector<Node> nodes_;
};

}  // namespace pointsweep
