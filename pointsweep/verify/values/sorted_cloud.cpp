// SPDX-License-Identifier: MIT
#include "pointsweep/verify/values/sorted_cloud.h"

#include <algorithm>
#include <tuple>

#include "pointsweep/cancellation.h"

namespace pointsweep {
namespace {

/// Bytes of memory for each point: the point while points are sorted, its place, numbers, and its part of the tree.
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
  tree_ = std::make_unique<formulas::PlaceTree>(places_, points_at_);
}

void SortedCloud::for_each_neighbor(const NeighborRule& rule,
                                    const std::function<void(std::uint32_t, std::uint32_t, double)>& use) const {
  const double reach2 = rule.radius * rule.radius;
  const bool all = rule.k == NeighborRule::kUnlimited;
  std::vector<formulas::PlaceTree::Near> near;
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
