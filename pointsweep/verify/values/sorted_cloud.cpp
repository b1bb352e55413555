// SPDX-License-Identifier: MIT
#include "pointsweep/verify/values/sorted_cloud.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "pointsweep/cancellation.h"

namespace pointsweep {
namespace {

constexpr std::uint32_t kLeaf = 12;

double squared(const PlaceTree::Place& p, const PlaceTree::Place& q) {
  const double dx = p[0] - q[0], dy = p[1] - q[1], dz = p[2] - q[2];
  return (dx * dx + dy * dy) + dz * dz;
}

}  // namespace

PlaceTree::PlaceTree(std::span<const Place> places, std::span<const std::uint32_t> points_at)
    : places_(places), points_at_(points_at), order_(places.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (order_.empty()) return;
  boxes_.push_back({{}, {}, 0, static_cast<std::uint32_t>(order_.size()), 0});
  for (std::uint32_t b = 0; b < boxes_.size(); ++b) build(b);
}

void PlaceTree::build(std::uint32_t b) {
  Box box = boxes_[b];
  box.low = box.high = places_[order_[box.begin]];
  for (std::uint32_t i = box.begin; i < box.end; ++i)
    for (std::size_t a = 0; a < 3; ++a) {
      box.low[a] = std::min(box.low[a], places_[order_[i]][a]);
      box.high[a] = std::max(box.high[a], places_[order_[i]][a]);
    }
  if (box.end - box.begin > kLeaf) {
    std::size_t longest = 0;
    for (std::size_t a = 1; a < 3; ++a)
      if (box.high[a] - box.low[a] > box.high[longest] - box.low[longest]) longest = a;
    const std::uint32_t middle = box.begin + (box.end - box.begin) / 2;
    std::nth_element(order_.begin() + box.begin, order_.begin() + middle, order_.begin() + box.end,
                     [&](std::uint32_t p, std::uint32_t q) { return places_[p][longest] < places_[q][longest]; });
    box.children = static_cast<std::uint32_t>(boxes_.size());
    boxes_.push_back({{}, {}, box.begin, middle, 0});
    boxes_.push_back({{}, {}, middle, box.end, 0});
  }
  boxes_[b] = box;
}

/// Returns the squared distance to the box, rounded like the distances of places, so that the result is never above the
/// distance of a place in the box.
double PlaceTree::distance2_to(const Box& box, const Place& p) const {
  Place nearest;
  for (std::size_t a = 0; a < 3; ++a) nearest[a] = std::clamp(p[a], box.low[a], box.high[a]);
  return squared(p, nearest);
}

template <class Visit>
void PlaceTree::descend(std::uint32_t b, const Place& p, const double& reach2, const Visit& visit) const {
  const Box& box = boxes_[b];
  if (box.children == 0) {
    for (std::uint32_t i = box.begin; i < box.end; ++i) visit(Near{squared(p, places_[order_[i]]), order_[i]});
    return;
  }
  const double first = distance2_to(boxes_[box.children], p), second = distance2_to(boxes_[box.children + 1], p);
  const std::uint32_t nearer = second < first ? 1 : 0;
  for (const std::uint32_t child : {nearer, 1 - nearer})
    if ((child == 0 ? first : second) <= reach2) descend(box.children + child, p, reach2, visit);
}

std::vector<PlaceTree::Near> PlaceTree::nearest(std::uint32_t place, std::size_t most, double reach2) const {
  std::vector<Near> found;  // heap of the nearest places, with the farthest of them in front
  std::size_t points = 0;   // number of points at the places in `found`
  descend(0, places_[place], reach2, [&](const Near& near) {
    if (!(near.distance2 <= reach2)) return;
    if (points >= most && !(near < found.front())) return;
    found.push_back(near);
    std::push_heap(found.begin(), found.end());
    points += points_at_[near.place];
    while (points - points_at_[found.front().place] >= most) {
      points -= points_at_[found.front().place];
      std::pop_heap(found.begin(), found.end());
      found.pop_back();
    }
    if (points >= most) reach2 = std::min(reach2, found.front().distance2);
  });
  std::sort(found.begin(), found.end());
  return found;
}

void PlaceTree::within(std::uint32_t place, double reach2, const std::function<void(const Near&)>& use) const {
  descend(0, places_[place], reach2, [&](const Near& near) {
    if (near.distance2 <= reach2) use(near);
  });
}

namespace {

/// Bytes of memory for each point: a Point while points are sorted, the place, six numbers of 32 bits, and a share of
/// the tree.
constexpr std::uint64_t kPointBytes = 32 + 24 + 6 * 4 + 20;

}  // namespace

SortedCloud::SortedCloud(const CloudInput& in, std::span<const ColumnSource> columns, std::uint64_t more_bytes) {
  for (const ColumnSource& c : columns) components_ += c.attribute.fields.size();
  const std::uint64_t count = in.rows.count();
  if (count >= kNone) throw NotTold("more than 2^32 points");
  require_memory(count * (kPointBytes + 2 * components_ * sizeof(double) + more_bytes), in.rows);
  struct Point {
    Vec3 position;
    std::uint64_t row;
  };
  std::vector<Point> points;
  std::vector<double> read;  // values of the points in the order of rows
  in.rows.for_each(columns, [&](std::uint64_t row, Vec3 p, std::span<const double> values) {
    if (!is_finite(p)) return;
    points.push_back({{p.x + 0.0, p.y + 0.0, p.z + 0.0}, row});
    read.insert(read.end(), values.begin(), values.end());
  });
  point_of_row_.assign(count, kNone);
  for (std::uint32_t i = 0; i < points.size(); ++i) point_of_row_[points[i].row] = i;
  std::ranges::sort(points, {},
                    [](const Point& p) { return std::tuple(p.position.x, p.position.y, p.position.z, p.row); });
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Vec3 p = points[i].position;
    if (i == 0 || points[i - 1].position != p) {
      places_.push_back({p.x, p.y, p.z});
      points_at_.push_back(0);
      first_at_.push_back(i);
    }
    ++points_at_.back();
    place_of_.push_back(static_cast<std::uint32_t>(places_.size() - 1));
    const double* values = read.data() + std::size_t{point_of_row_[points[i].row]} * components_;
    values_.insert(values_.end(), values, values + components_);
    point_of_row_[points[i].row] = i;
    row_of_.push_back(static_cast<std::uint32_t>(points[i].row));
  }
  tree_ = std::make_unique<PlaceTree>(places_, points_at_);
}

void SortedCloud::for_each_neighbor(const NeighborRule& rule,
                                    const std::function<void(std::uint32_t, std::uint32_t, double)>& use) const {
  const double reach2 = rule.radius * rule.radius;
  const bool all = rule.k == NeighborRule::kUnlimited;
  std::vector<PlaceTree::Near> near;
  for (std::uint32_t place = 0; place < places(); ++place) {
    stop_if_cancelled();
    near.clear();
    if (all)
      tree_->within(place, reach2, [&](const auto& n) { near.push_back(n); });
    else
      near = tree_->nearest(place, rule.k + 1, reach2);
    for (std::uint32_t i = first_at_[place]; i < first_at_[place] + points_at_[place]; ++i) {
      std::size_t left = rule.k;
      for (const auto& n : near)
        for (std::uint32_t j = first_at_[n.place]; j < first_at_[n.place] + points_at_[n.place] && left > 0; ++j)
          if (j != i) use(i, j, n.distance2), --left;
    }
  }
}

}  // namespace pointsweep
