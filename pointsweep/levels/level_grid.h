// SPDX-License-Identifier: MIT
/// The cube of the octree of levels of detail, over points on a grid of whole steps.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "pointsweep/geometry.h"
#include "pointsweep/levels/curve_key.h"

namespace pointsweep {

/// The coordinates of a point in whole steps of the grid, as LAS stores them.
using GridPoint = std::array<std::int32_t, 3>;

/// The least and the greatest coordinate on each axis.
struct GridBounds {
  GridPoint lo, hi;
  void include(const GridPoint& point) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lo[axis] = std::min(lo[axis], point[axis]);
      hi[axis] = std::max(hi[axis], point[axis]);
    }
  }
};

/// Returns the point with which a record begins.
inline GridPoint point_of(const std::byte* record) {
  GridPoint point;
  std::memcpy(point.data(), record, sizeof point);
  return point;
}

/// The cube and places in it. The unit of places is the step of the x axis, so that distances are exact if the steps of
/// all axes are equal and the points are not farther apart than 2^26 steps. If the longest step is more than 2^30 times
/// the step of x, the longest step is the unit instead. The corner of the cube lies half a step before the least
/// coordinates, and the width puts the faces of octants of 8 steps or more between the steps, so that readers with
/// other roundings find each point in the same octant.
class LevelGrid {
 public:
  /// `scale`: the length of a step on each axis, above 0.
  LevelGrid(const GridBounds& bounds, Vec3 scale);

  /// Returns the place of a point relative to the corner of the cube, in units.
  Vec3 place(const GridPoint& point) const {
    return {((point[0] - lo_.x) + 0.5) * step_.x, ((point[1] - lo_.y) + 0.5) * step_.y,
            ((point[2] - lo_.z) + 0.5) * step_.z};
  }
  CurveKey key(const GridPoint& point) const;
  Box box(const Octant& octant) const;
  double width() const { return width_; }
  /// Returns the corner of the cube in the coordinates of a file whose offset is `offset`.
  Vec3 corner(Vec3 offset) const;
  /// Returns the length of a unit of places in units of the cloud.
  double unit() const { return unit_; }

 private:
  std::uint32_t cell(double place) const;

  Vec3 scale_, lo_;
  double unit_;
  Vec3 step_;  ///< steps of the axes, in units
  double width_, cells_per_step_;
};

/// Returns a pseudo-random number that depends on the coordinates alone.
std::uint64_t rank_of(const GridPoint& point);

}  // namespace pointsweep
