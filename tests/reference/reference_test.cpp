// SPDX-License-Identifier: MIT
#include "reference/reference.h"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "pointsweep/error.h"
#include "pointsweep/operators/neighbor_rows.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/reference/reference_run.h"
#include "tests/support/brute_force.h"

namespace pointsweep::reference {
namespace {

constexpr double kFarAway = std::numeric_limits<double>::infinity();

Task graph(std::size_t k, std::size_t n, double radius = kFarAway) {
  return task_of(k, radius, {std::make_shared<NeighborRows>(k, n, false)});
}

std::vector<std::uint32_t> neighbors_in(const std::vector<std::byte>& result) {
  std::vector<std::uint32_t> rows(result.size() / sizeof(std::uint32_t));
  std::memcpy(rows.data(), result.data(), result.size());
  std::erase(rows, std::numeric_limits<std::uint32_t>::max());
  return rows;
}

std::vector<Vec3> closed_surface(std::size_t n) { return make_cloud(hostile_shapes()[0].second, n, 11); }

TEST(Reference, EveryNeighborhoodItCallsCompleteEqualsBruteForce) {
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, 1200, 5);
    for (const std::size_t k : {1, 8, 64}) {
      SCOPED_TRACE(name + ", k = " + std::to_string(k));
      const auto expected = brute_force_neighbors(points, k);
      const PointsRun run = run_on_points(points, graph(k, points.size()));
      std::uint64_t finite = 0, complete = 0, differing = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        ASSERT_EQ(is_finite(points[i]), !run.results[i].empty()) << i;
        if (!is_finite(points[i])) continue;
        const bool same = neighbors_in(run.results[i]) == expected[i];
        ASSERT_TRUE(same || !run.complete[i]) << i;
        ++finite;
        complete += run.complete[i];
        differing += !same;
      }
      const Statistics& s = run.statistics;
      EXPECT_EQ(s.complete, complete);
      EXPECT_EQ(s.complete + s.overlooked + s.unknown, finite);
      EXPECT_GE(differing, s.overlooked);
      EXPECT_LE(differing, s.overlooked + s.unknown);
      EXPECT_EQ(run.rows.size(), finite);
    }
  }
}

TEST(Reference, OfASurfaceSampledAtRandomNineteenNeighborhoodsInTwentyAreComplete) {
  const PointsRun run = run_on_points(closed_surface(20000), graph(8, 20000));
  EXPECT_GT(run.statistics.complete, 19000u);
  EXPECT_LT(run.statistics.peak_points, 20000u / 4);
  EXPECT_GT(run.statistics.lifespan_mean, 0);
}

TEST(Reference, NeighborhoodsWithinARadiusAreAllComplete) {
  const std::vector<Vec3> points = closed_surface(3000);
  const auto expected = brute_force_neighbors(points, 100, 0.1);
  const PointsRun run = run_on_points(points, graph(100, points.size(), 0.1));
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_EQ(neighbors_in(run.results[i]), expected[i]) << i;
  EXPECT_EQ(run.statistics.complete, points.size());
}

TEST(Reference, WritesInTheOrderOfTheStreamWhateverItsSlabs) {
  const std::vector<Vec3> points = closed_surface(5000);
  const PointsRun a = run_on_points(points, graph(8, points.size()), 300);
  const PointsRun b = run_on_points(points, graph(8, points.size()), 100000);
  EXPECT_EQ(a.rows, b.rows);
  EXPECT_EQ(a.results, b.results);
  EXPECT_EQ(a.complete, b.complete);
  for (std::size_t i = 1; i < a.rows.size(); ++i) ASSERT_LE(points[a.rows[i - 1]].z, points[a.rows[i]].z) << i;
}

TEST(Reference, TheBuffersTogetherAreTheActiveSet) {
  const Statistics s = run_on_points(closed_surface(5000), graph(8, 5000)).statistics;
  ASSERT_EQ(s.operators.size(), 4u);
  EXPECT_EQ(s.operators[0].name, "read");
  EXPECT_EQ(s.operators[1].name, "knn");
  EXPECT_EQ(s.operators[2].name, "neighbors");
  EXPECT_EQ(s.operators[3].name, "write");
  ASSERT_EQ(s.series.size(), 1000u);
  for (std::size_t i = 0; i < s.series.size(); ++i) {
    std::uint64_t sum = 0;
    for (const OperatorRecord& op : s.operators) {
      ASSERT_EQ(op.series[i].first, s.series[i].first);
      sum += op.series[i].second;
    }
    ASSERT_EQ(sum, s.series[i].second) << i;
  }
}

TEST(Reference, RefusesToGrowBeyondItsMemory) {
  const std::vector<Vec3> points = closed_surface(17000);
  try {
    run_on_points(points, graph(1, points.size()), 100000, {.memory_bytes = 1000, .progress = {}});
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("raise --memory, or leave out --engine reference"), std::string::npos);
  }
}

}  // namespace
}  // namespace pointsweep::reference
