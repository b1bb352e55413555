// SPDX-License-Identifier: MIT
#include "reference/kd_heap.h"

#include <algorithm>
#include <cmath>

#include "pointsweep/math/box.h"

namespace pointsweep::reference {

double KdHeap::end_of(const StreamPoint& point) const {
  return point.input[sweep_axis_] + std::sqrt(point.neighbors.reach2());
}

/// Returns whether no point at or after the plane can enter the neighbourhood of `point`. This holds despite rounding:
/// the rounded square of a difference of coordinates is never above the rounded distance2() of the points.
bool KdHeap::passed(const StreamPoint& point, double plane) const {
  const double ahead = plane - point.input[sweep_axis_];
  return ahead > 0 && ahead * ahead > point.neighbors.reach2();
}

void KdHeap::summarize(Node& node) const {
  node.size = 1;
  node.reach2 = node.point->neighbors.reach2();
  node.end = end_of(*node.point);
  node.last = node.point->input[sweep_axis_];
  for (const Node* below : {node.lower.get(), node.upper.get()}) {
    if (below == nullptr) continue;
    node.size += below->size;
    node.reach2 = std::max(node.reach2, below->reach2);
    node.end = std::min(node.end, below->end);
    node.last = std::max(node.last, below->last);
  }
}

int KdHeap::wider_axis(Vec3 extent) const {
  const int u = sweep_axis_ == 0 ? 1 : 0, v = sweep_axis_ == 2 ? 1 : 2;
  return extent[u] >= extent[v] ? u : v;
}

KdHeap::Link KdHeap::make(StreamPoint* point) {
  Link link;
  if (spare_.empty()) {
    link = std::make_unique<Node>();
  } else {
    link = std::move(spare_.back());
    spare_.pop_back();
  }
  link->point = point;
  return link;
}

void KdHeap::recycle(Link& link) { spare_.push_back(std::move(link)); }

void KdHeap::insert(StreamPoint& point) { insert(root_, &point); }

void KdHeap::insert(Link& link, StreamPoint* point) {
  if (!link) {
    link = make(point);
    return summarize(*link);
  }
  Node& node = *link;
  if (point->index < node.point->index) std::swap(point, node.point);
  if (node.is_leaf()) {
    const Vec3 a = node.point->input, b = point->input;
    node.axis = wider_axis({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
    node.split = 0.5 * a[node.axis] + 0.5 * b[node.axis];
  }
  insert(point->input[node.axis] < node.split ? node.lower : node.upper, point);
  summarize(node);
  const std::size_t heavier = std::max(node.lower ? node.lower->size : 0, node.upper ? node.upper->size : 0);
  if (4 * heavier > 3 * node.size + 8) rebuild(link);
}

void KdHeap::pop_smallest() { remove_top(root_); }

void KdHeap::remove_top(Link& link) {
  Node& node = *link;
  if (node.is_leaf()) return recycle(link);
  const bool lower = !node.upper || (node.lower && node.lower->point->index < node.upper->point->index);
  Link& next = lower ? node.lower : node.upper;
  node.point = next->point;
  remove_top(next);
  summarize(node);
}

void KdHeap::take_passed(double plane, std::vector<StreamPoint*>& out) { take_passed(root_, plane, out); }

void KdHeap::take_passed(Link& link, double plane, std::vector<StreamPoint*>& out) {
  if (!link || !(link->end < plane)) return;
  take_passed(link->lower, plane, out);
  take_passed(link->upper, plane, out);
  if (passed(*link->point, plane)) {
    out.push_back(link->point);
    remove_top(link);
  }
  if (link) summarize(*link);
}

/// A search for the points nearest to p, which visits the subtree on the side of p first. `beyond` is the vector from p
/// to the region of a subtree.
struct KdHeap::Search {
  Vec3 p;
  NearestSet& set;
  int sweep_axis;

  void visit(const Node* node, Vec3 beyond) const {
    if (node == nullptr) return;
    beyond[sweep_axis] = std::max(0.0, p[sweep_axis] - node->last);
    if (distance2(beyond, {}) > set.reach2()) return;
    set.offer(node->point->as_neighbor_of(p));
    if (node->is_leaf()) return;
    const double away = p[node->axis] - node->split;
    visit(away < 0 ? node->lower.get() : node->upper.get(), beyond);
    beyond[node->axis] = away;
    visit(away < 0 ? node->upper.get() : node->lower.get(), beyond);
  }
};

void KdHeap::find_nearest(Vec3 p, NearestSet& set) const { Search{p, set, sweep_axis_}.visit(root_.get(), {}); }

void KdHeap::offer_to_all(StreamPoint& point) {
  if (root_) offer_to_all(*root_, point, {});
}

/// Offers the point to all sets below the node; returns whether a set changed.
bool KdHeap::offer_to_all(Node& node, StreamPoint& point, Vec3 beyond) {
  if (distance2(beyond, {}) > node.reach2) return false;
  bool changed = node.point->neighbors.offer(point.as_neighbor_of(node.point->input));
  if (!node.is_leaf()) {
    const double away = point.input[node.axis] - node.split;
    Vec3 across = beyond;
    across[node.axis] = away;
    if (node.lower) changed |= offer_to_all(*node.lower, point, away < 0 ? beyond : across);
    if (node.upper) changed |= offer_to_all(*node.upper, point, away < 0 ? across : beyond);
  }
  if (changed) summarize(node);
  return changed;
}

void KdHeap::rebuild(Link& link) {
  std::vector<StreamPoint*> points;
  points.reserve(link->size);
  dissolve(link, points);
  link = build(points);
}

void KdHeap::dissolve(Link& link, std::vector<StreamPoint*>& points) {
  if (!link) return;
  points.push_back(link->point);
  dissolve(link->lower, points);
  dissolve(link->upper, points);
  recycle(link);
}

KdHeap::Link KdHeap::build(std::span<StreamPoint*> points) {
  if (points.empty()) return nullptr;
  const auto earlier = [](const StreamPoint* a, const StreamPoint* b) { return a->index < b->index; };
  std::iter_swap(points.begin(), std::ranges::min_element(points, earlier));
  Link link = make(points.front());
  points = points.subspan(1);
  if (!points.empty()) {
    Box box;
    for (const StreamPoint* p : points) box.include(p->input);
    link->axis = wider_axis(box.extent());
    const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
    std::nth_element(points.begin(), middle, points.end(),
                     [axis = link->axis](StreamPoint* a, StreamPoint* b) { return a->input[axis] < b->input[axis]; });
    link->split = (*middle)->input[link->axis];
    link->lower = build(points.first(points.size() / 2));
    link->upper = build(points.subspan(points.size() / 2));
  }
  summarize(*link);
  return link;
}

}  // namespace pointsweep::reference
