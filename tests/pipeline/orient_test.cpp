// SPDX-License-Identifier: MIT
/// The operator orient against Kruskal's algorithm in memory, and on surfaces whose outside is known.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>
#include <tuple>

#include "pointsweep/error.h"
#include "pointsweep/operators.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/brute_components.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

std::vector<Vec3> normals_in(const RunResult& result) {
  const auto x = result.field("nx"), y = result.field("ny"), z = result.field("nz");
  std::vector<Vec3> normals;
  for (std::size_t i = 0; i < x.size(); ++i) normals.push_back({x[i], y[i], z[i]});
  return normals;
}

struct Signed {
  std::vector<std::size_t> set;  ///< by point: row of the first point of its set, by x, y, z, row
  std::vector<int> sign;         ///< by point: sign relative to the first point of its set
};

/// Returns sets and signs by Kruskal's algorithm over all edges of the graph of the k nearest neighbours.
Signed signs_by_kruskal(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, std::size_t k) {
  const std::size_t n = points.size();
  std::vector<std::size_t> order(n), rank(n);
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::sort(order, {}, [&](std::size_t i) { return std::tuple(points[i].x, points[i].y, points[i].z, i); });
  for (std::size_t r = 0; r < n; ++r) rank[order[r]] = r;
  std::set<std::tuple<double, std::size_t, std::size_t>> edges;  // weight, and ranks of the ends
  const auto lists = nearest_rows(points, k);
  const auto along = [&](std::size_t i, std::size_t j) {
    return (normals[i].x * normals[j].x + normals[i].y * normals[j].y) + normals[i].z * normals[j].z;
  };
  for (std::size_t i = 0; i < n; ++i)
    for (const std::size_t j : lists[i])
      edges.emplace(1 - std::abs(along(i, j)), std::min(rank[i], rank[j]), std::max(rank[i], rank[j]));
  Signed out{rank, std::vector<int>(n, 1)};
  std::vector<std::vector<std::size_t>> members(n);
  for (std::size_t i = 0; i < n; ++i) members[rank[i]] = {i};
  for (const auto& [weight, a, b] : edges) {
    const std::size_t i = order[a], j = order[b];
    const std::size_t to = std::min(out.set[i], out.set[j]), from = std::max(out.set[i], out.set[j]);
    if (to == from) continue;
    const int turn = (along(i, j) < 0 ? -1 : 1) * out.sign[i] * out.sign[j];
    for (const std::size_t m : members[from]) out.set[m] = to, out.sign[m] *= turn, members[to].push_back(m);
    members[from].clear();
  }
  for (std::size_t& set : out.set) set = order[set];
  return out;
}

/// Returns the vote of a component with the points `rows`: positive if `sign` turns its normals the right way.
double vote_of(const std::vector<std::size_t>& rows, const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
               const std::vector<int>& sign) {
  Vec3 center;
  Box box;
  const double n = static_cast<double>(rows.size());
  for (const std::size_t i : rows) center = center + (1 / n) * points[i], box.include(points[i]);
  double up = 0, out = 0;
  const Vec3 extent = box.extent();
  const double mean = (extent.x + extent.y + extent.z) / 3;
  for (const std::size_t i : rows) {
    up += sign[i] * normals[i].z / n;
    if (mean > 0) out += sign[i] * dot(normals[i], points[i] - center) / mean / n;
  }
  return std::abs(std::abs(up) - std::abs(out)) < 1e-4 ? 0 : std::abs(up) > std::abs(out) ? up : out;
}

TEST(OrientedNormals, HaveTheSignsOfKruskalInMemory) {
  std::size_t decided = 0;
  for (const auto& [name, shape] : hostile_shapes()) {
    const Records input = with_attributes(make_cloud(shape, sized(500), 101));
    const std::vector<Vec3> points = input.positions();
    for (const std::size_t k : {3u, 9u}) {
      const std::vector<Vec3> normals =
          normals_in(run_text(input, fmt::format("knn(k={}) | normals", k), tiny(50'000)));
      const Signed expected = signs_by_kruskal(points, normals, k);
      std::vector<std::vector<std::size_t>> members(points.size());
      for (std::size_t i = 0; i < points.size(); ++i)
        if (is_finite(points[i])) members[expected.set[i]].push_back(i);
      std::vector<std::byte> first;
      for (const EngineOptions& options : ways_to_run()) {
        const RunResult got = run_text(input, fmt::format("knn(k={}) | normals | orient", k), options);
        if (first.empty()) first = got.records;
        ASSERT_EQ(got.records, first) << name;
        const std::vector<double> turned = got.field("normal_turned");
        const std::vector<Vec3> oriented = normals_in(got);
        for (std::size_t set = 0; set < points.size(); ++set) {
          for (const std::size_t i : members[set]) {
            ASSERT_EQ(turned[i] != turned[set], expected.sign[i] < 0) << name << ", k " << k << ", row " << i;
            ASSERT_EQ(oriented[i], (turned[i] != 0 ? -1.0 : 1.0) * normals[i]) << name << ", row " << i;
          }
          if (members[set].empty()) continue;
          const double vote = vote_of(members[set], points, normals, expected.sign);
          if (std::abs(vote) < 1e-4) continue;
          ++decided;
          ASSERT_EQ(turned[set] != 0, vote < 0) << name << ", k " << k << ", component of row " << set << ": " << vote;
        }
      }
    }
  }
  EXPECT_GT(decided, 20u);
}

/// Returns the share of normals that point to the side of `outside`.
template <class Outside>
double right_share(const RunResult& result, const std::vector<Vec3>& points, Outside outside) {
  const std::vector<Vec3> normals = normals_in(result);
  std::size_t right = 0;
  for (std::size_t i = 0; i < points.size(); ++i) right += dot(normals[i], outside(points[i])) > 0;
  return static_cast<double>(right) / static_cast<double>(points.size());
}

TEST(OrientedNormals, PointOutOfClosedSurfacesAndUpFromOpenOnes) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> g;
  std::vector<Vec3> sphere, torus, hills, bowl;
  for (std::size_t i = 0; i < sized(4000); ++i) {
    const Vec3 p{g(random), g(random), g(random)};
    sphere.push_back(Vec3{5e5, 5e6, 30} + (1 / length(p)) * p);
    const double a = 2 * M_PI * uniform(random), b = 2 * M_PI * uniform(random);
    torus.push_back({(1 + 0.4 * std::cos(b)) * std::cos(a), (1 + 0.4 * std::cos(b)) * std::sin(a), 0.4 * std::sin(b)});
    const double x = 10 * uniform(random), y = 10 * uniform(random);
    hills.push_back({x, y, std::sin(x) * std::cos(y)});
  }
  const auto share = [](const std::vector<Vec3>& points, const std::string& pipeline, auto outside) {
    return right_share(run_text(with_attributes(points), pipeline, tiny(700)), points, outside);
  };
  const std::string pipeline = "knn(k=12) | normals | orient";
  EXPECT_EQ(share(sphere, pipeline, [](Vec3 p) { return p - Vec3{5e5, 5e6, 30}; }), 1);
  EXPECT_EQ(share(sphere, "knn(k=12) | normals | orient(viewpoint=[500000,5000000,30])",
                  [](Vec3 p) {
                    return Vec3{5e5, 5e6, 30} - p;
                  }),
            1);
  EXPECT_EQ(share(torus, pipeline,
                  [](Vec3 p) {
                    const double r = std::hypot(p.x, p.y);
                    return Vec3{p.x - p.x / r, p.y - p.y / r, p.z};
                  }),
            1);
  EXPECT_EQ(share(hills, pipeline, [](Vec3) { return Vec3{0, 0, 1}; }), 1);
  EXPECT_EQ(share(hills, "knn(k=12) | normals | orient(viewpoint=[5,5,-100])", [](Vec3) { return Vec3{0, 0, -1}; }), 1);
}

/// A bad normal of the highest point must not turn all other normals, as an earlier rule did.
TEST(OrientedNormals, DoNotFollowTheHighestPointAlone) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> g;
  std::vector<Vec3> points = {{0, 0, 1.02}}, normals = {{0.995, 0, -0.0995}};
  while (points.size() < 3000) {
    const Vec3 p{g(random), g(random), g(random)};
    points.push_back((1 / length(p)) * p);
    normals.push_back((random() % 2 == 0 ? 1 : -1) * points.back());
  }
  const Records input = records_with_normals(points, normals);
  const RunResult got = run_text(input, "knn(k=8) | orient", tiny(500));
  EXPECT_GT(right_share(got, points, [](Vec3 p) { return p; }), 0.999);
}

TEST(OrientedNormals, LeaveTheFirstPointAsItIsWhereNothingDecides) {
  for (const double sign : {1.0, -1.0}) {
    std::vector<Vec3> points, normals;
    for (int i = 0; i < 2000; ++i) {
      points.push_back({3, static_cast<double>(i % 50), static_cast<double>(i / 50)});
      normals.push_back({i == 0 ? 0.5 * sign : -sign, 0, 0});  // the first point is joined last
    }
    const Records input = records_with_normals(points, normals);
    for (const EngineOptions& options : ways_to_run()) {
      const RunResult got = run_text(input, "knn(k=8) | orient", options);
      const auto x = got.field("nx");
      for (std::size_t i = 0; i < x.size(); ++i) ASSERT_EQ(x[i], i == 0 ? 0.5 * sign : sign);
    }
  }
}

TEST(OrientedNormals, NeedNormalsAndAFiniteViewpoint) {
  const Records input = with_attributes({{0, 0, 0}, {1, 0, 0}});
  EXPECT_NE(refusal([&] { run_text(input, "orient", tiny(100)); }).find("needs 'normal'"), std::string::npos);
  EXPECT_THROW(operators::orient({.viewpoint = Vec3{0, 0, std::numeric_limits<double>::infinity()}}), UsageError);
}

}  // namespace
}  // namespace pointsweep
