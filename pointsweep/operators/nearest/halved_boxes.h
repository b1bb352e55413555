// SPDX-License-Identifier: MIT
/// A tree of boxes over points in memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "pointsweep/math/box.h"
#include "pointsweep/operators/nearest/cell_point.h"

namespace pointsweep {

/// Boxes of points that are halved recursively: part j of level l is one of 2^l parts of nearly the same size.
class HalvedBoxes {
 public:
  /// Returns the number of levels below the whole at which no part of the last level has more than `most` points.
  static unsigned levels_for(std::size_t points, std::size_t most);
  /// Puts `points` in the order of the parts: each is halved across its widest extent.
  HalvedBoxes(std::span<CellPoint> points, unsigned levels, bool in_plane);

  unsigned levels() const { return levels_; }
  const Box& box(unsigned level, std::size_t j) const { return boxes_[(std::size_t{1} << level) - 1 + j]; }
  /// Returns the first point of part j of a level; for the part after the last one, the number of points.
  std::size_t begin(unsigned level, std::size_t j) const { return points_ * j >> level; }
  std::size_t begin(std::size_t j) const { return begin(levels_, j); }
  /// Calls `use(j)` for parts of the last level that are not farther than worst() at that moment, the nearer half
  /// first. Ends and returns false when `use` returns false.
  template <class Worst, class Use>
  bool nearest_first(Vec3 place, Worst worst, Use use) const {
    return descend(0, 0, distance2(box(0, 0), place), place, worst, use);
  }
  /// Calls `use(j)` for all parts of the last level whose boxes, and the boxes that contain them, are `wanted(box)`.
  /// Ends and returns false when `use` returns false.
  template <class Wanted, class Use>
  bool all_of(Wanted wanted, Use use, unsigned level = 0, std::size_t j = 0) const {
    if (!wanted(box(level, j))) return true;
    if (level == levels_) return use(j);
    return all_of(wanted, use, level + 1, 2 * j) && all_of(wanted, use, level + 1, 2 * j + 1);
  }

 private:
  template <class Worst, class Use>
  bool descend(unsigned level, std::size_t j, double d2, Vec3 place, Worst worst, Use use) const {
    if (d2 > worst()) return true;
    if (level == levels_) return use(j);
    const double first = distance2(box(level + 1, 2 * j), place), second = distance2(box(level + 1, 2 * j + 1), place);
    const std::size_t nearer = second < first;
    return descend(level + 1, 2 * j + nearer, std::min(first, second), place, worst, use) &&
           descend(level + 1, 2 * j + 1 - nearer, std::max(first, second), place, worst, use);
  }

  std::size_t points_;
  unsigned levels_;
  std::vector<Box> boxes_;
};

}  // namespace pointsweep
