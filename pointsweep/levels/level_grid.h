// SPDX-License-Identifier: MIT
/// The cube of the octree of levels of detail, over points on a grid of whole steps, its octants, and places on the
/// Morton curve through the cube. A cell is an octant of the greatest depth.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// The depth of the smallest octants.
inline constexpr int kMostDepth = 31;

/// The place of a cell on the curve: three bits (z, y, x) for each depth, the coarsest depth first.
struct CurveKey {
  std::uint64_t high = 0;  ///< depths 1 to 21
  std::uint32_t low = 0;   ///< depths 22 to 31
  friend auto operator<=>(const CurveKey&, const CurveKey&) = default;
};

/// An octant of the cube: one of 8^depth equal cubes.
struct Octant {
  int depth = 0;
  std::array<std::uint32_t, 3> at{};  ///< numbers of the octant along x, y and z
  friend bool operator==(const Octant&, const Octant&) = default;
};

namespace curve {

inline constexpr int kHighBits = 21, kLowBits = kMostDepth - kHighBits;

/// Puts two zeros in front of each of the lowest 21 bits, and drops the other bits.
inline std::uint64_t spread(std::uint64_t bits) {
  bits &= 0x1fffff;
  bits = (bits | bits << 32) & 0x1f00000000ffff;
  bits = (bits | bits << 16) & 0x1f0000ff0000ff;
  bits = (bits | bits << 8) & 0x100f00f00f00f00f;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
  return (bits | bits << 2) & 0x1249249249249249;
}

/// Undoes spread().
inline std::uint64_t gather(std::uint64_t bits) {
  bits &= 0x1249249249249249;
  bits = (bits | bits >> 2) & 0x10c30c30c30c30c3;
  bits = (bits | bits >> 4) & 0x100f00f00f00f00f;
  bits = (bits | bits >> 8) & 0x1f0000ff0000ff;
  bits = (bits | bits >> 16) & 0x1f00000000ffff;
  return (bits | bits >> 32) & 0x1fffff;
}

inline std::uint64_t interleave(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return spread(x) | spread(y) << 1 | spread(z) << 2;
}

}  // namespace curve

/// Returns the key of the cell with the numbers `cell` along x, y and z, each below 2^31.
inline CurveKey key_of_cell(const std::array<std::uint32_t, 3>& cell) {
  const auto [x, y, z] = cell;
  return {curve::interleave(x >> curve::kLowBits, y >> curve::kLowBits, z >> curve::kLowBits),
          static_cast<std::uint32_t>(curve::interleave(x & 1023, y & 1023, z & 1023))};
}

inline std::array<std::uint32_t, 3> cell_of_key(const CurveKey& key) {
  std::array<std::uint32_t, 3> cell;
  for (int axis = 0; axis < 3; ++axis)
    cell[axis] = static_cast<std::uint32_t>(curve::gather(key.high >> axis) << curve::kLowBits |
                                            curve::gather(std::uint64_t{key.low} >> axis));
  return cell;
}

/// Returns the octant of depth `depth` that holds the cell with this key.
inline Octant octant_of(const CurveKey& key, int depth) {
  Octant octant{depth, cell_of_key(key)};
  for (std::uint32_t& number : octant.at) number >>= kMostDepth - depth;
  return octant;
}

/// Returns the octant of the next lower depth that contains `octant`, which must not be the whole cube.
inline Octant parent_of(Octant octant) {
  --octant.depth;
  for (std::uint32_t& number : octant.at) number >>= 1;
  return octant;
}

/// Returns the least key in the octant.
inline CurveKey first_key(const Octant& octant) {
  std::array<std::uint32_t, 3> cell = octant.at;
  for (std::uint32_t& number : cell) number <<= kMostDepth - octant.depth;
  return key_of_cell(cell);
}

/// Returns the depth of the smallest octant that holds both cells.
inline int common_depth(const CurveKey& a, const CurveKey& b) {
  if (a.high != b.high) return (std::countl_zero(a.high ^ b.high) - 1) / 3;
  if (a.low != b.low) return curve::kHighBits + (std::countl_zero(a.low ^ b.low) - 2) / 3;
  return kMostDepth;
}

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

/// The cube and places in it. The unit of places is the step of the x axis, so that squared distances are exact if the
/// steps of all axes are equal and the points are not farther apart than 2^26 steps. If the longest step is more than
/// 2^30 times the step of x, the longest step is the unit instead. The corner of the cube lies half a step before the
/// least coordinates, and the width puts the faces of octants of 8 units or more between the steps of each axis whose
/// step is the unit, so that readers with other roundings find each point in the same octant.
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
