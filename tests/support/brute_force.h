// SPDX-License-Identifier: MIT
/// The slow and obvious oracle of every neighbour search: all pairs in double, sorted in the order that the library
/// documents.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <tuple>
#include <vector>

#include "pointsweep/geometry.h"

namespace pointsweep {

/// Returns the neighbours of points[query], nearest first: the k nearest with distance2 <= radius², without the point
/// itself; equal distances by x, then y, then z, then row. Points that are not finite have no neighbours and are
/// neighbours of none.
inline std::vector<std::uint32_t> brute_force_neighbors_of(std::span<const Vec3> points, std::uint32_t query,
                                                           std::size_t k, double radius) {
  std::vector<std::uint32_t> found;
  if (!is_finite(points[query])) return found;
  const auto key = [&](std::uint32_t row) {
    const Vec3 p = points[row];
    return std::tuple(distance2(p, points[query]), p.x, p.y, p.z, row);
  };
  for (std::uint32_t row = 0; row < points.size(); ++row)
    if (row != query && is_finite(points[row]) && distance2(points[row], points[query]) <= radius * radius)
      found.push_back(row);
  const auto nearer = [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); };
  if (k < found.size()) {
    std::nth_element(found.begin(), found.begin() + std::ptrdiff_t(k), found.end(), nearer);
    found.resize(k);
  }
  std::sort(found.begin(), found.end(), nearer);
  return found;
}

/// Returns one list for every entry of `queries` (rows).
inline std::vector<std::vector<std::uint32_t>> brute_force_neighbors(
    std::span<const Vec3> points, std::span<const std::uint32_t> queries, std::size_t k,
    double radius = std::numeric_limits<double>::infinity()) {
  std::vector<std::vector<std::uint32_t>> lists;
  lists.reserve(queries.size());
  for (const std::uint32_t query : queries) lists.push_back(brute_force_neighbors_of(points, query, k, radius));
  return lists;
}

/// Returns one list for every point.
inline std::vector<std::vector<std::uint32_t>> brute_force_neighbors(
    std::span<const Vec3> points, std::size_t k, double radius = std::numeric_limits<double>::infinity()) {
  std::vector<std::uint32_t> queries(points.size());
  std::iota(queries.begin(), queries.end(), 0u);
  return brute_force_neighbors(points, queries, k, radius);
}

}  // namespace pointsweep
