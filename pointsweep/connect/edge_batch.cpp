// SPDX-License-Identifier: MIT
#include "pointsweep/connect/edge_batch.h"

#include <algorithm>
#include <numeric>

#include "pointsweep/math/sort.h"

namespace pointsweep {

void EdgeBatch::clear() {
  numbers_.clear();
  points_.clear();
  edges_.clear();
}

std::uint32_t EdgeBatch::number_of(const PointKey& point) {
  const auto [number, is_new] = numbers_.add(point.row);
  if (is_new) {
    *number = static_cast<std::uint32_t>(points_.size());
    points_.push_back(point);
  }
  return *number;
}

/// Sorts the edges by weight with a vectorised sort, and edges of equal weight by the keys of their points.
void EdgeBatch::sort_edges() {
  order_.clear();
  for (std::size_t e = 0; e < edges_.size(); ++e) order_.emplace_back(edges_[e].weight, static_cast<double>(e));
  sort_ascending(order_);
  sorted_.clear();
  for (const auto& [weight, e] : order_) sorted_.push_back(edges_[static_cast<std::size_t>(e)]);
  edges_.swap(sorted_);
  const auto less = [this](const Edge& e, const Edge& f) {
    if (e.a != f.a) return points_[e.a] < points_[f.a];
    return e.b != f.b && points_[e.b] < points_[f.b];
  };
  for (auto first = edges_.begin(), end = first; first != edges_.end(); first = end) {
    while (end != edges_.end() && end->weight == first->weight) ++end;
    if (end - first == 1) continue;
    for (auto e = first; e != end; ++e)
      if (points_[e->b] < points_[e->a]) std::swap(e->a, e->b);
    std::sort(first, end, less);
  }
}

void EdgeBatch::reduce(bool weighted) {
  if (weighted) sort_edges();
  parents_.resize(points_.size());
  std::iota(parents_.begin(), parents_.end(), 0u);
  std::erase_if(edges_, [this](const Edge& e) {
    const std::uint32_t a = set_of(parents_, e.a), b = set_of(parents_, e.b);
    parents_[std::max(a, b)] = std::min(a, b);
    return a == b;
  });
}

ForestEdge EdgeBatch::forest_edge(const Edge& edge) const {
  const PointKey &a = points_[edge.a], &b = points_[edge.b];
  return b < a ? ForestEdge{edge.weight, b, a, edge.flips} : ForestEdge{edge.weight, a, b, edge.flips};
}

}  // namespace pointsweep
