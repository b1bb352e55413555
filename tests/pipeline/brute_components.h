// SPDX-License-Identifier: MIT
/// Components of small clouds by brute force: all pairs of points, and flood fill.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <tuple>
#include <vector>

#include "pointsweep/geometry.h"
#include "pointsweep/pipeline/engine_run.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/moving_clouds.h"

namespace pointsweep {

struct Labels {
  std::vector<double> component, size;
  bool operator==(const Labels&) const = default;
};

/// Sets of joined points, found by flood fill.
class Sets {
 public:
  explicit Sets(std::size_t n) : joined_(n) {}
  void join(std::size_t i, std::size_t j) {
    joined_[i].push_back(j);
    joined_[j].push_back(i);
  }
  /// Returns the components, numbered from 0, of the points i for which counts(i) is true; -1 for other points.
  template <class Counts>
  Labels labels(const std::vector<Vec3>& points, Counts counts) const {
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    std::erase_if(order, [&](std::size_t i) { return !is_finite(points[i]) || !counts(i); });
    std::ranges::sort(order, {}, [&](std::size_t i) { return std::tuple(points[i].x, points[i].y, points[i].z, i); });
    Labels labels{std::vector<double>(points.size(), -1), std::vector<double>(points.size(), 0)};
    double next = 0;
    for (const std::size_t first : order) {
      if (labels.component[first] >= 0) continue;
      std::vector<std::size_t> members = {first};
      labels.component[first] = next;
      for (std::size_t m = 0; m < members.size(); ++m)
        for (const std::size_t j : joined_[members[m]])
          if (labels.component[j] < 0) labels.component[j] = next, members.push_back(j);
      for (const std::size_t m : members) labels.size[m] = static_cast<double>(members.size());
      ++next;
    }
    return labels;
  }

  Labels labels(const std::vector<Vec3>& points) const {
    return labels(points, [](std::size_t) { return true; });
  }

 private:
  std::vector<std::vector<std::size_t>> joined_;
};

/// Returns for each point the rows of its k nearest points, nearest first.
inline std::vector<std::vector<std::size_t>> nearest_rows(const std::vector<Vec3>& points, std::size_t k) {
  std::vector<std::vector<std::size_t>> lists(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_finite(points[i])) continue;
    std::vector<std::tuple<double, double, double, double, std::size_t>> others;
    for (std::size_t j = 0; j < points.size(); ++j)
      if (j != i && is_finite(points[j]))
        others.emplace_back(distance2(points[i], points[j]), points[j].x, points[j].y, points[j].z, j);
    std::ranges::sort(others);
    others.resize(std::min(k, others.size()));
    for (const auto& other : others) lists[i].push_back(std::get<4>(other));
  }
  return lists;
}

/// Returns records of x, y, z as f64 and of normals as f32.
inline Records records_with_normals(const std::vector<Vec3>& points, const std::vector<Vec3>& normals) {
  Records out;
  for (const char* name : {"x", "y", "z"}) out.schema.append(name, Type::f64);
  for (const char* name : {"nx", "ny", "nz"}) out.schema.append(name, Type::f32);
  const auto put = [&](const auto& value) {
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    out.bytes.insert(out.bytes.end(), bytes, bytes + sizeof value);
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    put(points[i]);
    put(std::array{static_cast<float>(normals[i].x), static_cast<float>(normals[i].y),
                   static_cast<float>(normals[i].z)});
  }
  return out;
}

}  // namespace pointsweep
