// SPDX-License-Identifier: MIT
// Neighbourhoods within a radius in the whole engine: in little memory, with few lists at a time, and cancelled.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <future>
#include <thread>

#include "pointsweep/operators/statistics/neighbor_rows.h"
#include "pointsweep/operators/surface/curvature.h"
#include "pointsweep/operators/surface/fair.h"
#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/operators/surface/splats.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/memory/sample_estimates.h"
#include "pointsweep/program/pipeline.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/pipeline/in_memory.h"
#include "tests/support/brute_force.h"
#include "tests/support/sized.h"
#include "tests/support/watching.h"

namespace pointsweep {
namespace {

constexpr std::size_t kAll = Neighborhood::kUnlimited;

Chain chain_over(const std::vector<Vec3>& points, const std::string& text) {
  std::vector<double> xyz;
  for (const Vec3& p : points) xyz.insert(xyz.end(), {p.x, p.y, p.z});
  std::vector<std::unique_ptr<Reader>> readers;
  readers.push_back(std::make_unique<ArrayReader>(std::span<const double>(xyz)));
  InputCloud cloud(std::move(readers));
  return build_chain(parse_pipeline(text), cloud, {});
}

EngineOptions options_of(std::uint64_t slab_points, std::uint32_t cell_points, std::uint64_t lists_bytes) {
  EngineOptions options;
  options.slab_points = slab_points;
  options.cell_points = cell_points;
  options.lists_bytes = lists_bytes;
  options.resources.threads = 2;
  options.resources.memory_bytes = 1ull << 30;
  return options;
}

std::vector<Vec3> surface(std::size_t n) { return make_cloud(hostile_shapes()[0].second, n, 9); }

/// Bytes of lists, and whether neighbours are searched again and points are spilled. The clouds use each half by turns.
constexpr std::pair<std::uint64_t, bool> kFewLists[2][2] = {{{1, false}, {3000, true}}, {{1, true}, {3000, false}}};

TEST(Radius, BytesAreTheSameHoweverFewListsAThreadHasInHand) {
  std::size_t turn = 0;
  for (const auto& [name, shape] : hostile_shapes()) {
    if (name == "one place") continue;  // fair refuses it
    const std::vector<Vec3> points = make_cloud(shape, sized(600), 4);
    for (const char* text :
         {"knn(radius=0.15) | normals | curvature | splats | fair | normals", "knn(k=100) | normals | curvature",
          "knn(k=100, adaptive=eigenentropy) | normals | curvature", "knn(k=70, radius=0.2) | normals | splats | fair",
          "knn(radius=0.15) | normals | splats | fair | reneighbor | normals"}) {
      SCOPED_TRACE(name + ": " + text);
      const Chain chain = chain_over(points, text);
      const RunResult expected = run_in_memory(points, chain, options_of(1'000'000, 1024, 1u << 30));
      for (const auto& [lists, again] : kFewLists[turn++ % 2]) {
        EngineOptions options = options_of(300, 64, lists);
        options.search_again = options.spill = again;
        const RunResult result = run_in_memory(points, chain, options);
        ASSERT_EQ(result.records, expected.records) << lists << " bytes of lists, searched again: " << again;
        ASSERT_EQ(result.statistics.degenerate_results, expected.statistics.degenerate_results);
        ASSERT_EQ(result.statistics.certified, expected.statistics.certified);
      }
    }
  }
}

/// Sizes of the neighbourhood of each point: some are no limits, some exceed the found neighbours.
struct Sized {
  std::vector<double> xyz, count, reach;
  explicit Sized(const std::vector<Vec3>& points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      xyz.insert(xyz.end(), {points[i].x, points[i].y, points[i].z});
      count.push_back(i % 23 == 0 ? std::nan("") : static_cast<double>(i % 40) - 1);
      reach.push_back(i % 19 == 0 ? -1 : 0.01 * static_cast<double>(i % 30));
    }
  }
  InputCloud cloud() const {
    auto reader = std::make_unique<ArrayReader>(std::span<const double>(xyz));
    reader->add({"count"}, std::span<const double>(count));
    reader->add({"reach"}, std::span<const double>(reach));
    std::vector<std::unique_ptr<Reader>> readers;
    readers.push_back(std::move(reader));
    return InputCloud(std::move(readers));
  }
};

TEST(Radius, RulesShortenTheSameListsHoweverFewOfThemAThreadHasInHand) {
  std::size_t turn = 0;
  for (const auto& [name, shape] : hostile_shapes()) {
    if (name == "one place") continue;  // fair refuses it
    const Sized points(make_cloud(shape, sized(500), 14));
    for (const std::string rule :
         {"k_from=count", "radius_from=reach", "k_from=count, radius_from=reach", "adaptive=eigenentropy, k_min=4"}) {
      for (const std::string limit : {"radius=0.2", "k=45, radius=0.3", "k=70"}) {
        if (limit == "radius=0.2" && rule != "radius_from=reach") continue;  // the other rules need k
        const std::string chain_text =
            "knn(" + limit + ", " + rule + ") | neighborhood_size | normals | splats | curvature | fair(f=0.1, g=0.1)";
        SCOPED_TRACE(name + ": " + chain_text);
        const auto run = [&](const EngineOptions& options) {
          InputCloud cloud = points.cloud();
          return run_in_memory(cloud, build_chain(parse_pipeline(chain_text), cloud), options);
        };
        const RunResult expected = run(options_of(1'000'000, 1024, 1u << 30));
        for (const auto& [lists, again] : kFewLists[turn++ % 2]) {
          EngineOptions options = options_of(150, 64, lists);
          options.search_again = options.spill = again;
          const RunResult result = run(options);
          ASSERT_EQ(result.records, expected.records) << lists << " bytes of lists, searched again: " << again;
          ASSERT_EQ(result.statistics.degenerate_results, expected.statistics.degenerate_results);
        }
      }
    }
  }
}

TEST(Radius, NoPointIsEverRecalled) {
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, sized(3000), 3);
    const RunResult result =
        run_in_memory(points, chain_over(points, "knn(radius=0.1) | normals | curvature"), options_of(200, 64, 0));
    EXPECT_EQ(result.statistics.recalled, 0u) << name;
  }
}

TEST(Radius, TheWindowHoldsNoMoreThanTwoRadiiAndSomeSlabs) {
  std::vector<Vec3> points;
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> u(0, 1);
  for (std::size_t i = 0; i < 20'000; ++i) points.push_back({10 * u(rng), u(rng), 0.01 * u(rng)});
  const RunResult result =
      run_in_memory(points, chain_over(points, "knn(radius=0.5) | normals"), options_of(250, 64, 0));
  EXPECT_LT(result.statistics.peak_points, 2 * 0.5 * 2000 + 6 * 250)
      << "three radii would be 3,000 points and some slabs";
}

double mean_neighbors(const std::vector<Vec3>& points, double radius, std::size_t most) {
  double sum = 0;
  for (std::uint32_t i = 0; i < most; ++i)
    sum += static_cast<double>(brute_force_neighbors_of(points, i, points.size(), radius).size());
  return sum / static_cast<double>(most);
}

TEST(Radius, NeighborsAreEstimatedWithinAFactorOfTwoFromASampleOfThem) {
  std::mt19937_64 rng(2);
  std::uniform_real_distribution<double> u(0, 1);
  for (const bool volume : {false, true}) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < 100'000; ++i) points.push_back({u(rng), u(rng), volume ? u(rng) : 0});
    Survey survey;
    for (std::size_t i = 0; i < points.size(); i += 20) survey.sample.push_back(points[i]);
    for (const Vec3& p : survey.sample) survey.bounds.include(p);
    survey.dimension = volume ? 3 : 2;
    for (const double radius : {0.01, 0.03, 0.1, 0.3}) {
      const double truth = mean_neighbors(points, radius, 100);
      if (truth < 4) continue;
      const RadiusEstimate estimate = estimate_radius(survey, points.size(), radius);
      EXPECT_LT(estimate.neighbors, 2 * truth) << radius << ", volume: " << volume;
      EXPECT_GT(estimate.neighbors, truth / 2) << radius << ", volume: " << volume;
      EXPECT_GE(estimate.most_neighbors, estimate.neighbors);
      const std::uint64_t slice = estimate_slice(survey, points.size(), 2 * radius);
      EXPECT_GE(slice, static_cast<std::uint64_t>(100'000 * 2 * radius * 0.98));
      EXPECT_LE(slice, static_cast<std::uint64_t>(100'000 * 2 * radius * 1.5 + 2000));
    }
  }
}

TEST(Radius, EffortIsSaidInRoundNumbers) {
  EXPECT_EQ(neighbors_text(4123), "about 4,100 neighbours per point");
  EXPECT_EQ(neighbors_text(1'234'567), "about 1,200,000 neighbours per point");
  EXPECT_EQ(about_time_text(2412), "about 40 minutes");
  EXPECT_EQ(about_time_text(0.2), "about 1 second");
  EXPECT_EQ(about_time_text(200'000), "about 2 days");
}

TEST(Radius, ARunThatCannotFitIsRefusedBeforeTheWork) {
  const std::vector<Vec3> points = surface(200'000);
  EngineOptions options;
  options.resources.memory_bytes = 30u << 20;
  options.resources.threads = 1;
  try {
    run_in_memory(points, chain_over(points, "knn(radius=100) | normals"), options);
    ADD_FAILURE() << "200,000 points, each the neighbour of all, in 30 MB";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("give --memory "), std::string::npos) << error.what();
  }
}

/// The cloud is a plate across the axis. If the radius is its thickness, the window holds the whole plate, though no
/// point has many neighbours.
TEST(Radius, ABudgetCountsThePointsThatTheRadiusKeeps) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> u(0, 1);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < 400'000; ++i) points.push_back({0.1 * u(rng), 10 * u(rng), 10 * u(rng)});
  const auto least_megabytes = [&](const std::string& radius) {
    EngineOptions options;
    options.resources.memory_bytes = 1u << 20;
    options.resources.threads = 1;
    options.axis = 0;
    try {
      run_in_memory(points, chain_over(points, "knn(radius=" + radius + ") | normals"), options);
    } catch (const Error& error) {
      const std::string sentence = error.what();
      return std::stoul(sentence.substr(sentence.find("--memory ") + 9));
    }
    ADD_FAILURE() << "one megabyte is not enough for anything";
    return 0ul;
  };
  EXPECT_GE(least_megabytes("0.06"), least_megabytes("0.0001") + 12);
}

TEST(Radius, TheUserIsToldOfALongRunBeforeIt) {
  const std::vector<Vec3> points = surface(300'000);
  EngineOptions options;
  options.resources.memory_bytes = 1ull << 30;
  options.resources.threads = 1;
  std::string told;
  Watching watching({}, [&](const std::string& sentence) {
    told = sentence;
    watching.cancel();
  });
  options.observer = &watching;
  EXPECT_THROW(run_in_memory(points, chain_over(points, "knn(radius=100) | normals"), options), Cancelled);
  EXPECT_NE(told.find("about 300,000 neighbours per point, about "), std::string::npos) << told;
}

TEST(Radius, TheUserIsToldOfALongGroundBeforeIt) {
  std::vector<Vec3> points;
  for (int i = 0; i < 200; ++i)
    for (int j = 0; j < 200; ++j) points.push_back({i * 0.5, j * 0.5, i % 20 < 10 ? 5.0 : 0.0});
  points.push_back({1e7, -1e7, 0});
  EngineOptions options;
  options.resources.threads = 1;
  std::string told;
  Watching watching({}, [&](const std::string& sentence) {
    told = sentence;
    watching.cancel();
  });
  options.observer = &watching;
  EXPECT_NO_THROW(run_in_memory(points, chain_over(points, "ground(cell=1, window=10)"), options));
  EXPECT_EQ(told, "") << "an outlier far away alone makes no long run";
  EXPECT_THROW(run_in_memory(points, chain_over(points, "ground(cell=0.05, window=50)"), options), Cancelled);
  EXPECT_NE(told.find("The window means disks of up to 1000 cells over a raster of about "), std::string::npos) << told;
  EXPECT_NE(told.find("; larger cells or a smaller window take less."), std::string::npos) << told;
}

TEST(Radius, ACancelledRunEndsWithinASecond) {
  using Clock = std::chrono::steady_clock;
  const std::vector<Vec3> points = surface(300'000);
  const Chain chain = chain_over(points, "knn(radius=0.5) | normals | curvature");
  for (const int milliseconds : {50, 500, 1500}) {
    Observer observer;
    EngineOptions options = options_of(0, 1024, 0);
    options.observer = &observer;
    auto run = std::async(std::launch::async, [&] { run_in_memory(points, chain, options); });
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    const auto start = Clock::now();
    observer.cancel();
    EXPECT_THROW(run.get(), Cancelled) << "a run of minutes";
    EXPECT_LT(std::chrono::duration<double>(Clock::now() - start).count(), 1.0) << "after " << milliseconds << " ms";
  }
}

}  // namespace
}  // namespace pointsweep
