// SPDX-License-Identifier: MIT
/// The operators dbscan and segments against loops over all pairs.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
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

struct Clusters {
  std::vector<double> core;
  Labels labels;
  bool operator==(const Clusters&) const = default;
};

Clusters clusters_of_pairs(const std::vector<Vec3>& points, double eps, std::size_t min_points) {
  const std::size_t n = points.size();
  const auto near = [&](std::size_t i, std::size_t j) { return distance2(points[i], points[j]) <= eps * eps; };
  std::vector<double> core(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::size_t count = 0;
    for (std::size_t j = 0; j < n; ++j) count += near(i, j) || (i == j && is_finite(points[i]));
    core[i] = count >= min_points;
  }
  Sets sets(n);
  std::vector<bool> counts(n);
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<std::tuple<double, double, double, double, std::size_t>> cores;
    for (std::size_t j = 0; j < n; ++j)
      if (core[j] != 0 && near(i, j))
        cores.emplace_back(distance2(points[i], points[j]), points[j].x, points[j].y, points[j].z, j);
    counts[i] = !cores.empty();
    if (core[i] != 0)
      for (const auto& c : cores) sets.join(i, std::get<4>(c));
    else if (!cores.empty())
      sets.join(i, std::get<4>(*std::ranges::min_element(cores)));
  }
  return {core, sets.labels(points, [&](std::size_t i) { return counts[i]; })};
}

TEST(Dbscan, IsThatOfAllPairs) {
  std::size_t shapes = 0;
  for (const auto& [name, shape] : hostile_shapes()) {
    std::size_t turn = shapes++;
    const Records input = with_attributes(make_cloud(shape, sized(600), 91));
    for (const auto& [eps, min_points] :
         {std::pair(0.01, 3u), {0.05, 4u}, {0.05, 1u}, {0.3, 20u}, {1.0, 9u}, {2.0, 1000u}}) {
      const Clusters expected = clusters_of_pairs(input.positions(), eps, min_points);
      for (const EngineOptions& options : half_of_ways_to_run(turn++)) {
        const RunResult got =
            run_text(input, fmt::format("knn(radius={0}) | dbscan(eps={0}, min_points={1})", eps, min_points), options);
        const Clusters clusters{got.field("core"), {got.field("cluster"), got.field("cluster_size")}};
        ASSERT_EQ(clusters, expected) << name << ", eps " << eps << ", min_points " << min_points;
      }
    }
  }
}

/// After a move, the nearest core point may be at any place of a neighbour list. Clusters are numbered by the positions
/// of the search.
TEST(Dbscan, SeesThePointsWhereTheyAreNow) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[1].second, sized(1500), 93));
  const auto moved = [&](std::vector<ChainStage> stages) {
    InputCloud cloud = input.cloud();
    stages.insert(stages.begin(), thrown(0.02));
    stages.push_back(operators::dbscan({.eps = 0.07}));
    return run_in_memory(cloud, {.neighborhood = {.k = Neighborhood::kUnlimited, .radius = 0.2}, .stages = stages},
                         tiny(300));
  };
  const RunResult old_lists = moved({});
  const RunResult new_lists = moved({Reneighbor(Neighborhood{.k = Neighborhood::kUnlimited, .radius = 0.07})});
  EXPECT_EQ(old_lists.field("core"), new_lists.field("core"));
  EXPECT_EQ(old_lists.field("cluster_size"), new_lists.field("cluster_size"));
  std::map<double, double> number;
  const auto before = old_lists.field("cluster"), after = new_lists.field("cluster");
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(number.try_emplace(before[i], after[i]).first->second, after[i]) << i;
  EXPECT_GT(number.size(), 3u);
}

TEST(Dbscan, AsksForListsWithinEps) {
  const Records input = with_attributes({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  EXPECT_EQ(refusal([&] { run_text(input, "knn(k=8) | dbscan(eps=2)", tiny(100)); }),
            "pipeline, column 12: dbscan: needs more neighbours than the 8 nearest; write knn(radius=2) before it.");
  EXPECT_THROW(operators::dbscan({.eps = 0}), UsageError);
  EXPECT_THROW(operators::dbscan({.eps = 1, .min_points = 0}), UsageError);
  const RunResult got = run_text(input, "knn(radius=3) | dbscan(eps=1, min_points=3) | where(core == 0)", tiny(100));
  EXPECT_EQ(got.field("x"), (std::vector<double>{0, 2}));
  EXPECT_EQ(got.field("cluster"), (std::vector<double>{0, 0}));
}

Labels segments_of_pairs(const RunResult& with_normals, const std::vector<Vec3>& points, std::size_t k, double angle,
                         std::optional<double> distance) {
  const auto x = with_normals.field("nx"), y = with_normals.field("ny"), z = with_normals.field("nz");
  const auto lists = nearest_rows(points, k);
  Sets sets(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const std::size_t j : lists[i]) {
      const double along = std::abs(x[i] * x[j] + y[i] * y[j] + z[i] * z[j]);
      const bool is_near = !distance || distance2(points[i], points[j]) <= *distance * *distance;
      if (is_near && along > (angle == 90 ? 0 : std::cos(angle * M_PI / 180))) sets.join(i, j);
    }
  }
  return sets.labels(points);
}

TEST(Segments, AreThoseOfAllPairs) {
  std::size_t shapes = 0;
  for (const auto& [name, shape] : hostile_shapes()) {
    std::size_t turn = shapes++;
    const Records input = with_attributes(make_cloud(shape, sized(600), 92));
    const RunResult normals = run_text(input, "knn(k=7) | normals", tiny(50'000));
    for (const double angle : {0.5, 10.0, 40.0, 90.0}) {
      for (const std::optional<double> distance : {std::optional<double>(), std::optional(0.05)}) {
        const Labels expected = segments_of_pairs(normals, input.positions(), 7, angle, distance);
        const std::string text = fmt::format("knn(k=7) | normals | segments(angle={}{})", angle,
                                             distance ? fmt::format(", distance={}", *distance) : "");
        for (const EngineOptions& options : half_of_ways_to_run(turn++)) {
          const RunResult got = run_text(input, text, options);
          ASSERT_EQ((Labels{got.field("segment"), got.field("segment_size")}), expected) << name << ": " << text;
          ASSERT_EQ(got.field("nz").size(), normals.field("nz").size());
        }
      }
    }
  }
}

/// The cloud has three faces of a cube, and a sphere beside it.
TEST(Segments, DivideFacesAtTheirEdgesAndHoldWhatIsRound) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> g;
  std::vector<Vec3> points, normals;
  for (int i = 0; i < 9000; ++i) {
    Vec3 p{uniform(random), uniform(random), uniform(random)}, n;
    if (i % 4 < 3) {
      p[i % 4] = 0;
      n[i % 4] = random() % 2 == 0 ? 1 : -1;
    } else {
      p = {g(random), g(random), g(random)};
      n = (1 / length(p)) * p;
      p = Vec3{5, 5, 5} + n;
    }
    points.push_back(p);
    normals.push_back(n);
  }
  const RunResult got = run_text(records_with_normals(points, normals), "knn(k=12) | segments(angle=20)", tiny(700));
  const auto segment = got.field("segment");
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(segment[i] == segment[i % 4], true) << i;
  EXPECT_EQ((std::set<double>(segment.begin(), segment.end()).size()), 4u);
}

TEST(Segments, RefuseAnglesThatJoinNothing) {
  EXPECT_THROW(operators::segments({.angle = 0}), UsageError);
  EXPECT_THROW(operators::segments({.angle = 91}), UsageError);
  EXPECT_THROW(operators::segments({.distance = -1.0}), UsageError);
}

}  // namespace
}  // namespace pointsweep
