// SPDX-License-Identifier: MIT
/// The rows of degenerate results in the statistics, for clouds in which these rows are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>

#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/pipeline/in_memory.h"
#include "tests/support/reference_engine.h"

namespace pointsweep {
namespace {

using Rows = std::vector<std::uint64_t>;

/// A flat grid, on which every result is defined, and groups of points far from the grid, which lack some results. Rows
/// are in random order. Within a radius of 2 and with at most 8 neighbours no group reaches another.
struct HandMade {
  std::vector<Vec3> points;
  Rows without_plane;   ///< rows of points in one place, on a line, in pairs and alone
  Rows without_shapes;  ///< rows in without_plane, and triangles, whose points have a plane but no curvature

  HandMade() {
    std::vector<std::pair<Vec3, char>> all;
    for (int x = 0; x < 12; ++x)
      for (int y = 0; y < 12; ++y) all.push_back({{double(x), double(y), 0}, ' '});
    for (int i = 0; i < 12; ++i) all.push_back({{50, 7, 3}, 'p'});
    for (int i = 0; i < 20; ++i) all.push_back({{100.0 + 0.5 * i, 3, 2}, 'p'});
    for (int i = 0; i < 6; ++i)
      for (const double x : {0.0, 1.0}) all.push_back({{150 + 10 * i + x, 5, 5}, 'p'});
    all.push_back({{-500, 0, 0}, 'p'});
    for (int i = 0; i < 5; ++i)
      for (const Vec3 p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0.5, 1, 0}})
        all.push_back({Vec3{-100.0 + 10 * i, 0, 0} + p, 't'});
    std::ranges::shuffle(all, std::mt19937(5));
    for (std::uint64_t row = 0; row < all.size(); ++row) {
      points.push_back(all[row].first);
      if (all[row].second == 'p') without_plane.push_back(row);
      if (all[row].second != ' ') without_shapes.push_back(row);
    }
  }
};

RunResult run_text(const std::vector<Vec3>& points, const std::string& text, const EngineOptions& options) {
  std::vector<double> xyz;
  for (const Vec3& p : points) xyz.insert(xyz.end(), {p.x, p.y, p.z});
  std::vector<std::unique_ptr<Reader>> readers;
  readers.push_back(std::make_unique<ArrayReader>(std::span<const double>(xyz)));
  InputCloud cloud(std::move(readers));
  return run_in_memory(cloud, build_chain(parse_pipeline(text), cloud), options);
}

/// Returns options with different threads, memory, slabs, cells and orders, each also with the reference engine.
std::vector<EngineOptions> many_options() {
  std::vector<EngineOptions> all;
  for (const std::uint64_t slab : {30, 1'000'000}) {
    for (const unsigned threads : {1u, 3u}) {
      for (const bool again : {false, true}) {
        EngineOptions options;
        options.slab_points = slab, options.cell_points = slab == 30 ? 16 : 1024, options.resources.threads = threads;
        options.spill = options.search_again = again;
        options.lists_bytes = again ? 1 : 0;
        options.order = threads == 1 ? Order::input : Order::sweep;
        all.push_back(options);
      }
    }
    for (const Order order : {Order::input, Order::sweep}) {
      EngineOptions options;
      options.engine = Engine::reference, options.order = order, options.slab_points = slab;
      all.push_back(options);
    }
  }
  return all;
}

void expect_rows(const Statistics& got, const std::vector<std::pair<std::string, Rows>>& expected) {
  std::uint64_t all = 0;
  ASSERT_EQ(got.degenerate_results.size(), expected.size());
  for (std::size_t s = 0; s < expected.size(); ++s) {
    EXPECT_EQ(got.degenerate_results[s],
              (DegenerateResults{expected[s].first, expected[s].second.size(), expected[s].second}))
        << "stage " << s << ", " << expected[s].first;
    all += expected[s].second.size();
  }
  EXPECT_EQ(got.degenerate, all);
}

TEST(DegenerateResults, AreListedByStageAndRowHoweverTheRunIsDone) {
  const HandMade made;
  for (const EngineOptions& options : many_options()) {
    expect_rows(
        run_text(made.points, "knn(k=8, radius=2) | normals | curvature | splats | fair(f=1, g=1)", options).statistics,
        {{"normals", made.without_plane},
         {"curvature", made.without_shapes},
         {"splats", made.without_plane},
         {"fair", made.without_plane}});
  }
}

/// Fairing moves no point out of its plane, so equal points lack results before and after it, with old and new
/// neighbourhoods.
TEST(DegenerateResults, AreListedForEachStageOfALongChainWithMovers) {
  const HandMade made;
  for (const EngineOptions& options : many_options()) {
    expect_rows(run_text(made.points,
                         "knn(k=8, radius=2) | normals | splats | fair(f=1, g=1) | normals | reneighbor | normals | "
                         "curvature | splats",
                         options)
                    .statistics,
                {{"normals", made.without_plane},
                 {"splats", made.without_plane},
                 {"fair", made.without_plane},
                 {"normals", made.without_plane},
                 {"normals", made.without_plane},
                 {"curvature", made.without_shapes},
                 {"splats", made.without_plane}});
  }
}

/// Returns the rows whose fields are all 0: the documented values are a normal of length 0 and a splat of length 0.
Rows rows_of_zeros(const RunResult& result, const std::vector<Vec3>& points, const std::vector<std::string>& fields) {
  std::vector<bool> zero(points.size(), true);
  for (const std::string& name : fields) {
    const std::vector<double> values = result.field(name);
    for (std::size_t row = 0; row < values.size(); ++row) zero[row] = zero[row] && values[row] == 0;
  }
  Rows rows;
  for (std::uint64_t row = 0; row < points.size(); ++row)
    if (zero[row] && is_finite(points[row])) rows.push_back(row);
  return rows;
}

TEST(DegenerateResults, OfRecalledPointsAreCountedOnce) {
  std::uint64_t recalled = 0, degenerate = 0;
  for (const auto& [name, shape] : hostile_shapes()) {
    for (const unsigned threads : {1u, 2u, 3u}) {
      const std::vector<Vec3> points = make_cloud(shape, 900, 16 + threads);
      SCOPED_TRACE(name);
      EngineOptions options;
      options.slab_points = 60, options.cell_points = 16, options.resources.threads = threads;
      const RunResult result = run_text(points, "knn(k=9) | normals | curvature | splats", options);
      const auto& stages = result.statistics.degenerate_results;
      ASSERT_EQ(stages.size(), 3u);
      EXPECT_EQ(stages[0].rows, rows_of_zeros(result, points, {"nx", "ny", "nz"}));
      EXPECT_EQ(stages[2].rows, rows_of_zeros(result, points, {"splat_length"}));
      for (const DegenerateResults& stage : stages) EXPECT_EQ(stage.count, stage.rows.size());
      EngineOptions at_once;
      at_once.slab_points = 1'000'000, at_once.resources.threads = 1;
      const RunResult whole = run_text(points, "knn(k=9) | normals | curvature | splats", at_once);
      EXPECT_EQ(whole.statistics.recalled, 0u);
      EXPECT_EQ(stages, whole.statistics.degenerate_results);
      recalled += result.statistics.recalled, degenerate += result.statistics.degenerate;
    }
  }
  EXPECT_GT(recalled, 100u);
  EXPECT_GT(degenerate, 1000u);
}

/// All clouds are projected to the x axis, so that no point has a result.
TEST(DegenerateResults, OfPointsOnALineAreEachCountedOnceAlsoWhereTheyAreRecalled) {
  std::uint64_t recalled = 0;
  for (const std::uint64_t seed : {6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17}) {
    for (const auto& [name, shape] : hostile_shapes()) {
      SCOPED_TRACE(name);
      std::vector<Vec3> points;
      for (const Vec3& p : make_cloud(shape, 1500, seed))
        if (is_finite(p)) points.push_back({p.x, 0, 0});
      Rows lowest(1000);
      std::iota(lowest.begin(), lowest.end(), std::uint64_t{0});
      EngineOptions options;
      options.slab_points = 60, options.cell_points = 16, options.resources.threads = 2;
      const Statistics s = run_text(points, "knn(k=5) | normals | curvature | splats", options).statistics;
      recalled += s.recalled;
      for (const DegenerateResults& stage : s.degenerate_results)
        EXPECT_EQ(stage, (DegenerateResults{stage.stage, points.size(), lowest}));
    }
  }
  EXPECT_GT(recalled, 25u);
}

}  // namespace
}  // namespace pointsweep
