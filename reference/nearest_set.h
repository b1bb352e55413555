// SPDX-License-Identifier: MIT
/// The neighbourhood N_i of a point while it is being found, and after (paper Section 4.2.2).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <tuple>
#include <vector>

#include "pointsweep/geometry.h"

namespace pointsweep::reference {

struct StreamPoint;

/// The order of neighbours: by distance, ties by x, y, z of the input, and row.
struct Rank {
  double distance2;
  Vec3 position;
  std::uint64_t row;

  friend bool operator<(const Rank& a, const Rank& b) {
    return std::tie(a.distance2, a.position.x, a.position.y, a.position.z, a.row) <
           std::tie(b.distance2, b.position.x, b.position.y, b.position.z, b.row);
  }
};

/// A point as a neighbour of another.
struct Neighbor {
  double distance2;
  StreamPoint* point;

  Rank rank() const;
};

/// The limits of a neighbourhood: the k nearest points, and none of them farther than the radius.
struct Reach {
  std::size_t k;
  double radius2;
};

/// Filled first with the nearest of the points before p_i in the stream (left-sided), then with every later one that
/// comes nearer than the farthest of them (right-sided): both sides are merged as they come.
class NearestSet {
 public:
  explicit NearestSet(Reach reach) : k_(reach.k), reach2_(reach.radius2) {}

  /// Squared distance within which a point may enter: of the farthest neighbour if there are k, else of the radius.
  double reach2() const { return reach2_; }
  bool full() const { return found_.size() == k_; }
  /// Offers a point to the set; returns whether the set changed. O(log k).
  bool offer(const Neighbor& candidate);
  /// Puts the nearest first. Ends the filling.
  void sort();
  /// Keeps the `count` nearest of the neighbours found as N_i; called after sort().
  void keep(std::size_t count) { kept_ = count; }

  std::size_t k() const { return k_; }
  /// All neighbours found: sorted after sort(), a heap with the farthest on top before.
  std::span<const Neighbor> found() const { return found_; }
  /// N_i: all neighbours found, or as many of them as keep() says.
  std::span<const Neighbor> kept() const { return found().first(std::min(kept_, found_.size())); }
  std::size_t bytes() const { return found_.capacity() * sizeof(Neighbor); }

 private:
  std::size_t k_;
  double reach2_;
  std::size_t kept_ = std::numeric_limits<std::size_t>::max();
  std::vector<Neighbor> found_;
};

}  // namespace pointsweep::reference
