// SPDX-License-Identifier: MIT
/// Exact neighbours of every point of a cloud of some 100,000 points by a plain grid: all points of the cells around a
/// point, ring by ring, until no unseen cell can hold a nearer point. Shares no code with the library's search.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <tuple>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/math/box.h"

namespace pointsweep {

class GridNeighbors {
 public:
  /// Makes cells so wide that a cell would hold about `per_cell` points if the points lay on a square surface.
  explicit GridNeighbors(std::span<const Vec3> points, double per_cell = 4) : points_(points) {
    Box box;
    for (const Vec3& p : points)
      if (is_finite(p)) box.include(p);
    low_ = box.lo;
    const Vec3 size = box.extent();
    const double longest = std::max({size.x, size.y, size.z});
    width_ = longest > 0 ? longest * std::sqrt(per_cell / static_cast<double>(points.size())) : 1;
    for (std::uint32_t row = 0; row < points.size(); ++row)
      if (is_finite(points[row])) cells_[cell_of(points[row])].push_back(row);
    farthest_cell_ = static_cast<std::int64_t>(longest / width_) + 1;
  }

  /// Returns the rows of the k nearest points with distance2 <= radius², without the point itself, nearest first, ties
  /// by x, y, z, row.
  std::vector<std::uint32_t> of(std::uint32_t row, std::size_t k, double radius) const {
    std::vector<Key> found;
    const Vec3 p = points_[row];
    if (!is_finite(p)) return {};
    for (std::int64_t ring = 0; ring <= farthest_cell_; ++ring) {
      add_ring(row, ring, radius * radius, found);
      const double seen = static_cast<double>(ring) * width_ * (1 - 1e-9);  // all points within this distance are found
      if (seen > radius) break;
      if (found.size() < k) continue;
      std::nth_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(k - 1), found.end());
      if (std::get<0>(found[k - 1]) < seen * seen) break;
    }
    std::sort(found.begin(), found.end());
    if (found.size() > k) found.resize(k);
    std::vector<std::uint32_t> rows;
    for (const Key& key : found) rows.push_back(std::get<4>(key));
    return rows;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  using Key = std::tuple<double, double, double, double, std::uint32_t>;

  Cell cell_of(Vec3 p) const {
    const auto along = [&](double v, double low) { return static_cast<std::int64_t>(std::floor((v - low) / width_)); };
    return {along(p.x, low_.x), along(p.y, low_.y), along(p.z, low_.z)};
  }

  /// Adds the points of the cells that are `ring` cells away in the maximum norm.
  void add_ring(std::uint32_t row, std::int64_t ring, double radius2, std::vector<Key>& found) const {
    const Cell c = cell_of(points_[row]);
    for (std::int64_t x = -ring; x <= ring; ++x)
      for (std::int64_t y = -ring; y <= ring; ++y) {
        const bool inner = std::abs(x) < ring && std::abs(y) < ring;
        for (std::int64_t z = -ring; z <= ring; z += inner ? std::max<std::int64_t>(2 * ring, 1) : 1) {
          const auto cell = cells_.find({c[0] + x, c[1] + y, c[2] + z});
          if (cell == cells_.end()) continue;
          for (const std::uint32_t other : cell->second) {
            const Vec3 q = points_[other];
            const double d2 = distance2(q, points_[row]);
            if (other != row && d2 <= radius2) found.emplace_back(d2, q.x, q.y, q.z, other);
          }
        }
      }
  }

  std::span<const Vec3> points_;
  Vec3 low_;
  double width_;
  std::int64_t farthest_cell_;
  std::map<Cell, std::vector<std::uint32_t>> cells_;
};

}  // namespace pointsweep
