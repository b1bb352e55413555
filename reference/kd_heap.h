// SPDX-License-Identifier: MIT
/// The kD-heap S: a dynamic, semi-balanced 2-D kD-tree over the sweep plane with an integrated priority heap over the
/// stream index (paper Section 4.2.2).
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "reference/stream_point.h"

namespace pointsweep::reference {

/// A kD-tree that is also a heap. Each node has a point and a line that divides the points below it; the point itself
/// may lie on either side. So the smallest index can be at the top of every subtree (heap), and a point is removed by
/// moving up the smaller of the two points below it, down to a leaf, while all lines stay (kD-tree).
///
/// Three more numbers per subtree save visits: the largest reach of its points, the smallest coordinate on the sweep
/// axis at which one of their neighbourhoods ends, and the largest coordinate of the points on this axis.
///
/// Semi-balanced: if, after an insertion, one side of a node holds more than three quarters of the points of its
/// subtree and two points more, the subtree is rebuilt (a scapegoat tree). Equal coordinates may stand on both sides of
/// a line, so duplicates cannot unbalance it. Depth is O(log m), insertion and removal O(log m), amortised; the paper
/// says no more of its balancing than the name.
///
/// Points are borrowed. While a point is in the heap, its `input` and `index` must not change, and its reach only by
/// offer_to_all().
class KdHeap {
 public:
  explicit KdHeap(int sweep_axis) : sweep_axis_(sweep_axis) {}

  bool empty() const { return root_ == nullptr; }
  std::size_t size() const { return root_ ? root_->size : 0; }
  /// Returns the point of smallest index. The heap must not be empty.
  StreamPoint& smallest() const { return *root_->point; }

  void insert(StreamPoint& point);
  void pop_smallest();
  /// Removes the points whose neighbourhoods end before the plane, and appends them to `out` in no particular order.
  void take_passed(double plane, std::vector<StreamPoint*>& out);

  /// Offers the points near p to `set`, which then equals the result of brute force over all points of the heap.
  void find_nearest(Vec3 p, NearestSet& set) const;
  /// Offers `point` to the neighbour set of each point within whose reach it lies.
  void offer_to_all(StreamPoint& point);

 private:
  struct Node {
    StreamPoint* point = nullptr;
    std::unique_ptr<Node> lower, upper;
    int axis = 0;
    double split = 0;
    std::size_t size = 1;
    double reach2 = 0;  ///< largest squared reach in the subtree
    double end = 0;     ///< smallest end of a neighbourhood in the subtree, along the sweep axis
    double last = 0;    ///< largest coordinate on the sweep axis in the subtree
    bool is_leaf() const { return !lower && !upper; }
  };
  using Link = std::unique_ptr<Node>;
  struct Search;

  double end_of(const StreamPoint& point) const;
  bool passed(const StreamPoint& point, double plane) const;
  void summarize(Node& node) const;
  int wider_axis(Vec3 extent) const;
  Link make(StreamPoint* point);
  void recycle(Link& link);

  void insert(Link& link, StreamPoint* point);
  void remove_top(Link& link);
  void take_passed(Link& link, double plane, std::vector<StreamPoint*>& out);
  bool offer_to_all(Node& node, StreamPoint& point, Vec3 beyond);
  void rebuild(Link& link);
  void dissolve(Link& link, std::vector<StreamPoint*>& points);
  Link build(std::span<StreamPoint*> points);

  int sweep_axis_;
  Link root_;
  std::vector<Link> spare_;
};

}  // namespace pointsweep::reference
