// SPDX-License-Identifier: MIT
/// Points of a searched set in memory, a tree of boxes over them, a request for the nearest points, and the nearest
/// points that a search has seen so far.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <tuple>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/math/box.h"

namespace pointsweep {

struct CellPoint {
  Vec3 position;
  std::uint64_t row;
};

/// A point of the searched set, with its squared distance from the place of the search.
struct CellNeighbor {
  double distance2;  ///< (dx² + dy²) + dz² in float64; dx² + dy² in Space::plane
  Vec3 position;
  std::uint64_t row;

  /// Orders by distance, equal distances by x, y, z, row.
  bool operator<(const CellNeighbor& other) const {
    const auto key = [](const CellNeighbor& n) {
      return std::tuple(n.distance2, n.position.x, n.position.y, n.position.z, n.row);
    };
    return key(*this) < key(other);
  }
};

/// A request for the nearest points of a set.
struct NearestWanted {
  std::size_t k = 1;
  double most2 = std::numeric_limits<double>::infinity();  ///< largest squared distance of a point that is wanted
  bool any_of_equal = false;  ///< true if any of several points at equal distances may be returned
  /// Number of seen points after which a search may end if it has found k points. The search then returns the nearest
  /// of the points that it has seen.
  std::size_t most_seen = std::numeric_limits<std::size_t>::max();
};

/// The nearest points that a search has seen so far: at most k, in the order of CellNeighbor.
class NearestSoFar {
 public:
  void begin(const NearestWanted& wanted) {
    wanted_ = wanted;
    worst_ = wanted.most2;
    seen_ = 0;
    found_.clear();
  }
  bool full() const { return found_.size() == wanted_.k; }
  /// Returns the squared distance beyond which points are not needed; -1 if the search may end.
  double worst() const { return full() && seen_ >= wanted_.most_seen ? -1 : worst_; }
  void see(double distance2, const CellPoint& point) {
    ++seen_;
    if (distance2 > worst_) return;
    const CellNeighbor next{distance2, point.position, point.row};
    if (full()) {
      if (!(next < found_.back())) return;
      found_.pop_back();
    }
    found_.insert(std::upper_bound(found_.begin(), found_.end(), next), next);
    if (full()) worst_ = wanted_.any_of_equal ? below(found_.back().distance2) : found_.back().distance2;
  }
  const std::vector<CellNeighbor>& found() const { return found_; }
  /// Returns the number of points seen so far.
  std::size_t seen() const { return seen_; }

 private:
  /// Returns a slightly smaller number, for points that must be strictly nearer; -1 for 0.
  static double below(double distance2) { return distance2 > 0 ? distance2 * (1 - 0x1p-53) : -1; }

  NearestWanted wanted_;
  double worst_ = 0;
  std::size_t seen_ = 0;
  std::vector<CellNeighbor> found_;
};

/// A tree of boxes: the points are halved recursively, and each part has a box around its points. Level l has 2^l parts
/// with nearly equal numbers of points.
class HalvedBoxes {
 public:
  /// Returns the least number of halvings after which no part has more than `most` points.
  static unsigned levels_for(std::size_t points, std::size_t most) {
    unsigned levels = 0;
    while (((points - 1) >> levels) >= most) ++levels;
    return levels;
  }
  /// Halves each part across its widest extent, and puts `points` in the order of the parts. `in_plane`: true if boxes
  /// and halvings ignore z.
  HalvedBoxes(std::span<CellPoint> points, unsigned levels, bool in_plane)
      : points_(points.size()), levels_(levels), boxes_((std::size_t{2} << levels) - 1) {
    for (unsigned level = 0; level <= levels_; ++level) {
      for (std::size_t j = 0; j < std::size_t{1} << level; ++j) {
        const std::span<CellPoint> part = points.subspan(begin(level, j), begin(level, j + 1) - begin(level, j));
        Box& own = boxes_[(std::size_t{1} << level) - 1 + j];
        for (const CellPoint& p : part) own.include(in_plane ? Vec3{p.position.x, p.position.y, 0} : p.position);
        if (level == levels_) continue;
        const std::size_t middle = begin(level + 1, 2 * j + 1) - begin(level, j);
        std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(middle), part.end(),
                         [axis = own.longest_axis()](const CellPoint& a, const CellPoint& b) {
                           return a.position[axis] < b.position[axis];
                         });
      }
    }
  }

  unsigned levels() const { return levels_; }
  /// Returns the number of parts of the last level.
  std::size_t parts() const { return std::size_t{1} << levels_; }
  const Box& box(unsigned level, std::size_t j) const { return boxes_[(std::size_t{1} << level) - 1 + j]; }
  /// Returns the index of the first point of part j of a level; the number of points if j is the number of parts.
  std::size_t begin(unsigned level, std::size_t j) const { return points_ * j >> level; }
  std::size_t begin(std::size_t j) const { return begin(levels_, j); }
  /// Calls `use(j)` for each part j of the last level whose box has a squared distance of at most worst() from `place`.
  /// Visits the nearer half of each part first, and calls worst() again before each visit. Ends and returns false when
  /// `use` returns false.
  template <class Worst, class Use>
  bool nearest_first(Vec3 place, Worst worst, Use use) const {
    return descend(0, 0, distance2(box(0, 0), place), place, worst, use);
  }
  /// Calls `use(j)` for each part j of the last level if `wanted(box)` is true for the box of the part and for all
  /// boxes that contain it. Ends and returns false when `use` returns false.
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
