// SPDX-License-Identifier: MIT
/// The operator sor against a plain evaluation in long double over neighbours found by brute force, and partial sums
/// against each other.
#include "pointsweep/operators/statistics/outliers.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pointsweep/operators.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/oracles/clouds.h"
#include "tests/oracles/grid_neighbors.h"
#include "tests/oracles/oracle.h"
#include "tests/pipeline/in_memory.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/support/brute_force.h"

namespace pointsweep {
namespace {

using Real = long double;

Real distance(Vec3 a, Vec3 b) {
  const Real dx = Real{a.x} - b.x, dy = Real{a.y} - b.y, dz = Real{a.z} - b.z;
  return std::sqrt(dx * dx + dy * dy + dz * dz);
}

/// Outliers from neighbour lists and positions: mean distances, and the threshold mean + multiplier * deviation.
struct PlainOutliers {
  std::vector<Real> mean_distance;  ///< NaN for points without neighbours
  Real threshold = 0;
  OutlierDefinition definition;

  PlainOutliers(const std::vector<Vec3>& now, const std::vector<std::vector<std::uint32_t>>& lists, Real multiplier,
                OutlierDefinition of = OutlierDefinition::pointsweep)
      : definition(of) {
    const bool open3d = of == OutlierDefinition::open3d;
    Real sum = 0, n = 0;
    for (std::size_t i = 0; i < now.size(); ++i) {
      Real mean = 0;
      const Real by = static_cast<Real>(lists[i].size()) + (open3d ? 1 : 0);
      for (const std::uint32_t j : lists[i]) mean += distance(now[i], now[j]) / by;
      if (lists[i].empty() || !std::isfinite(mean)) mean = std::nanl("");
      mean_distance.push_back(mean);
      if (!std::isnan(mean)) sum += mean, n += 1;
    }
    Real squares = 0;
    for (const Real d : mean_distance)
      if (!std::isnan(d) && !(open3d && d == 0)) squares += (d - sum / n) * (d - sum / n);
    const Real by = of == OutlierDefinition::cloudcompare ? n : n - 1;
    threshold = sum / n + multiplier * (by > 0 ? std::sqrt(squares / by) : 0);
  }

  bool is_outlier(Real d) const {
    if (definition == OutlierDefinition::pdal) return d >= threshold;
    if (definition == OutlierDefinition::open3d) return d >= threshold || d == 0;
    return d > threshold;
  }
};

void expect_plain(const RunResult& got, const PlainOutliers& plain) {
  const std::vector<double> mean = got.field("mean_distance"), outlier = got.field("outlier");
  ASSERT_EQ(mean.size(), plain.mean_distance.size());
  for (std::size_t i = 0; i < mean.size(); ++i) {
    const Real expected = plain.mean_distance[i];
    if (std::isnan(expected)) {
      EXPECT_TRUE(std::isnan(mean[i])) << i;
      EXPECT_EQ(outlier[i], 1) << i;
      continue;
    }
    ASSERT_NEAR(mean[i], static_cast<double>(expected), 1e-13 * static_cast<double>(expected)) << i;
    const bool decided = std::abs(expected - plain.threshold) > 1e-12L * plain.threshold;
    ASSERT_TRUE(!decided || (outlier[i] != 0) == plain.is_outlier(expected)) << i;
  }
}

constexpr double kFar = std::numeric_limits<double>::infinity();

Chain sor_chain(Neighborhood neighborhood, double multiplier,
                OutlierDefinition definition = OutlierDefinition::pointsweep) {
  return {std::move(neighborhood), {operators::sor({multiplier, definition})}};
}

constexpr OutlierDefinition kAllDefinitions[] = {OutlierDefinition::pointsweep, OutlierDefinition::pdal,
                                                 OutlierDefinition::pcl, OutlierDefinition::open3d,
                                                 OutlierDefinition::cloudcompare};

TEST(Outliers, OfHostileCloudsAreThoseOfThePlainFormula) {
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    const std::vector<Vec3> points = make_cloud(shape, 700, 21);
    for (const auto& [k, radius] :
         {std::pair(std::size_t{6}, kFar), {std::size_t{12}, 0.05}, {Neighborhood::kUnlimited, 0.1}}) {
      const PlainOutliers plain(points, brute_force_neighbors(points, k, radius), 1.5L);
      RunResult first;
      for (const EngineOptions& options : {tiny(60, false, 1), tiny(200, true, 3), tiny(50'000, false, 2)}) {
        RunResult got = run_in_memory(points, sor_chain({.k = k, .radius = radius}, 1.5), options);
        expect_plain(got, plain);
        if (first.records.empty()) first = got;
        ASSERT_TRUE(got.records == first.records);
      }
    }
  }
}

TEST(Outliers, OfEveryDefinitionAreThoseOfItsPlainFormula) {
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, 600, 25);
    const auto lists = brute_force_neighbors(points, 5, kFar);
    for (const OutlierDefinition definition : kAllDefinitions) {
      SCOPED_TRACE(name + ", definition " + std::to_string(static_cast<int>(definition)));
      const PlainOutliers plain(points, lists, 1, definition);
      const RunResult got = run_in_memory(points, sor_chain({.k = 5}, 1, definition), tiny(90, true));
      expect_plain(got, plain);
      ASSERT_EQ(got.records, run_in_memory(points, sor_chain({.k = 5}, 1, definition), tiny(5000, false, 3)).records);
    }
  }
}

/// All distances are 1, so all points lie exactly at the mean; then copies of a point are added.
TEST(Outliers, AtTheThresholdAreWhatTheDefinitionSays) {
  std::vector<Vec3> points;
  for (int i = 0; i < 40; ++i) points.push_back({double(i), 0, 0});
  for (const OutlierDefinition definition : kAllDefinitions) {
    const bool at_threshold = definition == OutlierDefinition::pdal || definition == OutlierDefinition::open3d;
    for (const double outlier : run_in_memory(points, sor_chain({.k = 1}, 3, definition), tiny(100)).field("outlier"))
      EXPECT_EQ(outlier, at_threshold) << static_cast<int>(definition);
  }
  points.assign(20, {0, 0, 0});
  for (int i = 1; i < 40; ++i) points.push_back({double(i * i), 0, 0});
  for (const OutlierDefinition definition : kAllDefinitions) {
    const auto outlier = run_in_memory(points, sor_chain({.k = 2}, 3, definition), tiny(100)).field("outlier");
    EXPECT_EQ(outlier[0], definition == OutlierDefinition::open3d) << static_cast<int>(definition);
  }
}

TEST(Outliers, BehindAMoverAreThoseOfMovedPositionsInTheOldLists) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, 800, 22);
  const Throw mover(0.1);
  std::vector<Vec3> moved;
  for (std::size_t i = 0; i < points.size(); ++i) moved.push_back(mover.moved(points[i], i));
  const auto sor = operators::sor();
  expect_plain(run_in_memory(points, {{.k = 7}, {thrown(0.1), sor}}, tiny(90)),
               PlainOutliers(moved, brute_force_neighbors(points, 7, kFar), 2));
  expect_plain(run_in_memory(points, {{.k = 7}, {thrown(0.1), reneighbor(5), sor}}, tiny(90, true)),
               PlainOutliers(moved, brute_force_neighbors(moved, 5, kFar), 2));
}

TEST(Outliers, WithNeighborhoodsThatAdapt) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, 500, 23);
  const std::string rest = " | neighborhood_size | sor(multiplier=1)";
  const RunResult got = run_in_memory(
      points, build_chain(parse_pipeline("knn(k=20, adaptive=eigenentropy, k_min=4)" + rest), Facts{}), tiny(90));
  const std::vector<double> counts = got.field("neighbor_count");
  std::vector<std::vector<std::uint32_t>> lists = brute_force_neighbors(points, 20, kFar);
  for (std::size_t i = 0; i < lists.size(); ++i) lists[i].resize(static_cast<std::size_t>(counts[i]));
  expect_plain(got, PlainOutliers(points, lists, 1));
}

TEST(Outliers, TheDeviationOfCloseValuesFarFromZeroIsExact) {
  const MeanAndDeviation reduction(mean_distance_attribute());
  const std::vector<double> values = {1e8 + 1e-7, 1e8 - 1e-7, 1e8, std::nan(""), 1e8 + 2e-8};
  const std::unique_ptr<Accumulator> all = reduction.start(), a = reduction.start(), b = reduction.start();
  all->add(values.data(), values.size());
  b->add(values.data(), 2), a->add(values.data() + 2, 3);
  a->merge(*b);
  Real mean = 0, squares = 0;
  for (const double v : values)
    if (!std::isnan(v)) mean += Real{v} / 4;
  for (const double v : values)
    if (!std::isnan(v)) squares += (v - mean) * (v - mean);
  EXPECT_EQ(all->finish(), a->finish());
  EXPECT_EQ(all->finish()[0], static_cast<double>(mean));
  EXPECT_NEAR(all->finish()[1], static_cast<double>(std::sqrt(squares / 3)), 1e-18);
  EXPECT_EQ(all->finish()[2], 4);
}

TEST(Outliers, OfRealCloudsAreThoseOfThePlainFormula) {
  for (const RealCloud& real : real_clouds()) {
    SCOPED_TRACE(real.name);
    InputCloud cloud({real.file});
    RowSource source(cloud);
    const std::vector<Vec3> points = positions_of(source);
    const GridNeighbors grid(points);
    std::vector<std::vector<std::uint32_t>> lists;
    for (std::uint32_t i = 0; i < points.size(); ++i)
      lists.push_back(is_finite(points[i]) ? grid.of(i, 8, kFar) : std::vector<std::uint32_t>{});
    expect_plain(run_in_memory(cloud, sor_chain({.k = 8}, 2), tiny(20'000, true)), PlainOutliers(points, lists, 2));
  }
}

TEST(Outliers, DenoiseKeepsThePointsThatAreNone) {
  std::vector<Vec3> points = make_cloud(hostile_shapes().front().second, 700, 21);
  points[3].x = std::numeric_limits<double>::quiet_NaN();
  for (const OutlierDefinition definition : kAllDefinitions) {
    const std::vector<double> outlier =
        run_in_memory(points, sor_chain({.k = 6}, 0.5, definition), tiny(90)).field("outlier");
    const Chain chain{{.k = 6}, {operators::denoise({0.5, definition})}};
    const RunResult kept = run_in_memory(points, chain, tiny(90, true));
    std::vector<double> expected;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (outlier[i] == 0) expected.push_back(points[i].x);
    EXPECT_EQ(kept.field("x"), expected);
    EXPECT_EQ(kept.schema.fields.size(), 3u);
  }
}

TEST(Outliers, EqualDistancesHaveNoOutliers) {
  const RunResult got = run_in_memory(std::vector<Vec3>(50, {1, 2, 3}), sor_chain({.k = 4}, 0), tiny(100));
  for (const double outlier : got.field("outlier")) EXPECT_EQ(outlier, 0);
  for (const double mean : got.field("mean_distance")) EXPECT_EQ(mean, 0);
}

}  // namespace
}  // namespace pointsweep
