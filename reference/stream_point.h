// SPDX-License-Identifier: MIT
/// A point of the active set with all its fields (the paper's AllFields, Section 5.1 and Figure 10), and its
/// neighbourhood N_i during and after the search (Section 4.2.2).
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <span>
#include <tuple>
#include <vector>

#include "pointsweep/geometry.h"

namespace pointsweep::reference {

struct StreamPoint;

/// The key by which neighbours are ordered: by distance, ties by x, y, z of the input, then by row.
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

  inline Rank rank() const;

  /// Orders by rank().
  friend bool operator<(const Neighbor& a, const Neighbor& b) {
    return a.distance2 != b.distance2 ? a.distance2 < b.distance2 : a.rank() < b.rank();
  }
};

/// The limits of a neighbourhood: the k nearest points, and none of them farther than the radius.
struct Reach {
  std::size_t k;
  double radius2;
};

/// The k nearest points of p_i. The set is first filled with points before p_i in the stream (left-sided), then with
/// later points (right-sided). A set with k points takes a point that ranks before its farthest point, and drops that
/// one; a smaller set takes every point offered within the radius.
class NearestSet {
 public:
  explicit NearestSet(Reach reach) : k_(reach.k), reach2_(reach.radius2) {}

  /// Returns the squared distance within which a point may enter: that of the farthest neighbour if the set has k
  /// neighbours, else the squared radius.
  double reach2() const { return reach2_; }
  bool full() const { return found_.size() == k_; }
  /// Offers a point to the set; returns whether the set changed. O(log k).
  bool offer(const Neighbor& candidate) {
    if (candidate.distance2 > reach2_) return false;
    if (full()) {
      if (!(candidate < found_.front())) return false;
      std::pop_heap(found_.begin(), found_.end());
      found_.back() = candidate;
    } else {
      if (found_.empty()) found_.reserve(std::min(k_, kReserved));
      found_.push_back(candidate);
    }
    std::push_heap(found_.begin(), found_.end());
    if (full()) reach2_ = found_.front().distance2;
    return true;
  }
  /// Sorts the points found, nearest first. No point may be offered afterwards.
  void sort() { std::sort_heap(found_.begin(), found_.end()); }
  /// Keeps the `count` nearest of the neighbours found as N_i; called after sort().
  void keep(std::size_t count) { kept_ = count; }

  std::size_t k() const { return k_; }
  /// Returns all neighbours found: sorted after sort(), before that a heap with the farthest on top.
  std::span<const Neighbor> found() const { return found_; }
  /// Returns N_i: all neighbours found, or as many as keep() has set.
  std::span<const Neighbor> kept() const { return found().first(std::min(kept_, found_.size())); }
  std::size_t bytes() const { return found_.capacity() * sizeof(Neighbor); }

 private:
  static constexpr std::size_t kReserved = 512;  ///< initial capacity; larger sets grow

  std::size_t k_;
  double reach2_;
  std::size_t kept_ = std::numeric_limits<std::size_t>::max();
  std::vector<Neighbor> found_;
};

/// The index that means no point: larger than the index of every point.
inline constexpr std::uint64_t kNoIndex = std::numeric_limits<std::uint64_t>::max();

struct StreamPoint {
  StreamPoint(Vec3 p, std::uint64_t input_row, std::uint64_t stream_index, Reach reach)
      : input(p), position(p), row(input_row), index(stream_index), neighbors(reach) {}

  // Set when the point is read
  Vec3 input;           ///< position in the input, which search and order use
  Vec3 position;        ///< current position, after operators that move points
  std::uint64_t row;    ///< row in the input
  std::uint64_t index;  ///< place in the stream, i in the paper
  std::chrono::steady_clock::time_point read_at;

  // Set by the search for neighbours
  NearestSet neighbors;
  std::uint64_t min_index = kNoIndex;  ///< smallest index of the point and its neighbours, or a lower bound
  std::uint64_t max_index = 0;         ///< largest index of the point and its neighbours; known once they are complete

  // Points that the search could not see when the point came (Audit)
  static constexpr double kNothing = std::numeric_limits<double>::infinity();
  std::vector<Rank> hidden;    ///< the nearest of the active points that had left S, nearest first
  std::uint64_t written = 0;   ///< number of points of the stream that had been written by then
  double written2 = kNothing;  ///< squared distance along the axis to the last written point, unless `written` is 0

  // Every other field, at the places that Fields gives them: the record of the file, attributes, an operator's copies
  std::unique_ptr<std::byte[]> fields;

  Neighbor as_neighbor_of(Vec3 p) { return {distance2(input, p), this}; }
};

inline Rank Neighbor::rank() const { return {distance2, point->input, point->row}; }

/// The active set A: all points read and not yet written, a FIFO queue in stream order (Section 3).
using ActiveSet = std::deque<StreamPoint>;

}  // namespace pointsweep::reference
