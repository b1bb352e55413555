// SPDX-License-Identifier: MIT
/// Points of a searched set, a request for the nearest points, and the nearest points that a search has seen so far.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <vector>

#include "pointsweep/geometry.h"

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
  /// Number of points after which a search may end if it has found k; it then returns the nearest of the points seen.
  std::size_t most_seen = std::numeric_limits<std::size_t>::max();
};

/// The at most k nearest points seen so far, in order.
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

}  // namespace pointsweep
