// SPDX-License-Identifier: MIT
// The reference engine through run(), against brute force and against itself.
#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <numeric>
#include <thread>

#include "pointsweep/error.h"
#include "pointsweep/order/survey.h"
#include "tests/order/cloud_source.h"
#include "tests/reference/reference_runs.h"
#include "tests/support/brute_force.h"
#include "tests/support/watching.h"

namespace pointsweep {
namespace {

std::vector<Vec3> closed_surface(std::size_t n) { return make_cloud(hostile_shapes()[0].second, n, 11); }

std::string text(Order order) { return order == Order::input ? ", input order" : ", sweep order"; }

std::uint64_t finite_points(const std::vector<Vec3>& points) {
  return static_cast<std::uint64_t>(std::count_if(points.begin(), points.end(), [](Vec3 p) { return is_finite(p); }));
}

/// Returns a radius within which most points of the cloud have a few neighbours.
double typical_reach(const std::vector<Vec3>& points) {
  std::vector<double> reach;
  for (std::uint32_t i = 0; i < points.size(); i += 50)
    if (const auto list = brute_force_neighbors_of(points, i, 20, Box::kInf); !list.empty())
      reach.push_back(std::sqrt(distance2(points[list.back()], points[i])));
  std::nth_element(reach.begin(), reach.begin() + std::ptrdiff_t(reach.size() / 2), reach.end());
  return reach[reach.size() / 2];
}

TEST(Reference, PointsEnterInCanonicalOrderWhateverOrderTheOutputHas) {
  for (const auto& [name, shape] : trying_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, 2000, 5);
    std::vector<std::uint32_t> expected = canonical_rows(points);
    expected.resize(finite_points(points));
    for (const Order order : kOrders) {
      SCOPED_TRACE(name + text(order));
      EXPECT_EQ(neighbor_run(points, {.k = 2}, 2, by(Engine::reference, order)).entered, expected);
    }
  }
}

TEST(Reference, AuditCountsEveryListThatDiffersFromBruteForceAndNoOther) {
  std::uint64_t differ = 0;
  for (const auto& [name, shape] : trying_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, 900, 5);
    const Lists most = brute_force_neighbors(points, 64);
    for (const std::size_t k : {1, 8, 64}) {
      Lists exact = most;
      for (auto& list : exact) list.resize(std::min(k, list.size()));
      for (const Order order : kOrders) {
        SCOPED_TRACE(name + ", k = " + std::to_string(k) + text(order));
        const NeighborRun run = neighbor_run(points, {.k = k}, k, by(Engine::reference, order));
        EXPECT_EQ(run.statistics.reference->incomplete, differing(run.lists, exact));
        EXPECT_EQ(run.statistics.reference->complete + run.statistics.reference->incomplete, finite_points(points));
        EXPECT_EQ(run.statistics.certified, run.statistics.reference->complete);
        differ += run.statistics.reference->incomplete;
      }
    }
  }
  EXPECT_GT(differ, 1000u) << "the audit was not put to the test";
}

TEST(Reference, AuditReadsManyNeighborhoodsAgainThatReachWrittenPoints) {
  // Points of a thin sheet have neighbours in the dense sheet before it. Most of the dense sheet is written when the
  // second point of the thin sheet comes. The points of the thin sheet are settled in several batches, because each
  // takes 5 KB until it is settled.
  const CloudShape sheets = [](auto& r) {
    const double x = std::floor(20 * uniform(r)) + (uniform(r) < 0.06 ? 0.5 : 0);
    return Vec3{x + 1e-3 * uniform(r), uniform(r), uniform(r)};
  };
  const std::vector<Vec3> points = make_cloud(sheets, 12000, 8);
  const Lists exact = brute_force_neighbors(points, 64);
  for (const Order order : kOrders) {
    const NeighborRun run = neighbor_run(points, {.k = 64}, 64, by(Engine::reference, order));
    EXPECT_EQ(run.statistics.reference->incomplete, differing(run.lists, exact)) << text(order);
  }
}

TEST(Reference, NeighborhoodsWithinARadiusAreExactOnEveryCloud) {
  constexpr std::size_t kWidth = 40;
  for (const auto& [name, shape] : trying_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, 900, 6);
    const double radius = typical_reach(points);
    const Lists exact = brute_force_neighbors(points, points.size(), radius);
    for (const Order order : kOrders) {
      SCOPED_TRACE(name + text(order));
      const NeighborRun run =
          neighbor_run(points, {.k = Neighborhood::kUnlimited, .radius = radius}, kWidth, by(Engine::reference, order));
      EXPECT_EQ(run.statistics.reference->complete, finite_points(points));
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (!is_finite(points[i])) continue;
        ASSERT_EQ(run.counts[i], double(exact[i].size())) << i;
        const auto end = exact[i].begin() + std::ptrdiff_t(std::min(kWidth, exact[i].size()));
        ASSERT_EQ(run.lists[i], std::vector<std::uint32_t>(exact[i].begin(), end)) << i;
      }
    }
  }
}

TEST(Reference, TheNearestWithinARadiusAreCountedByTheAuditToo) {
  for (const auto& [name, shape] : trying_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, 900, 7);
    const double radius = typical_reach(points);
    const Lists exact = brute_force_neighbors(points, 8, radius);
    for (const Order order : kOrders) {
      SCOPED_TRACE(name + text(order));
      const NeighborRun run = neighbor_run(points, {.k = 8, .radius = radius}, 8, by(Engine::reference, order));
      EXPECT_EQ(run.statistics.reference->incomplete, differing(run.lists, exact));
    }
  }
}

TEST(Reference, TheActiveSetOfAClosedSurfaceIsSmallInEitherOrder) {
  const std::vector<Vec3> points = closed_surface(20000);
  const NeighborRun input = neighbor_run(points, {.k = 8}, 8, by(Engine::reference, Order::input));
  const NeighborRun sweep = neighbor_run(points, {.k = 8}, 8, by(Engine::reference, Order::sweep));
  EXPECT_LT(input.statistics.peak_points, points.size() / 10);
  EXPECT_EQ(input.statistics.peak_points, sweep.statistics.peak_points);
  EXPECT_EQ(input.statistics.series, sweep.statistics.series);
  EXPECT_GT(input.statistics.reference->complete, 19000u);
  EXPECT_GT(input.statistics.lifespan_mean_seconds, 0);
}

TEST(Reference, RecordsAreTheSameInEitherOrderWithAnySlabsAndMemory) {
  for (const auto& [name, shape] : trying_shapes()) {
    SCOPED_TRACE(name);
    const std::vector<Vec3> points = make_cloud(shape, 1200, 9);
    const NeighborRun expected = neighbor_run(points, {.k = 8}, 8, by(Engine::reference));
    for (const Order order : kOrders) {
      EngineOptions spilled = by(Engine::reference, order, 1000);
      spilled.spill = true, spilled.resources.threads = 3;
      for (const EngineOptions& options :
           {by(Engine::reference, order), by(Engine::reference, order, 100000), spilled}) {
        const NeighborRun run = neighbor_run(points, {.k = 8}, 8, options);
        EXPECT_EQ(run.records, expected.records);
        EXPECT_EQ(run.statistics.reference->incomplete, expected.statistics.reference->incomplete);
      }
    }
  }
}

TEST(Reference, ListsDoNotDependOnTheOrderOfTheInput) {
  const std::vector<Vec3> points = closed_surface(5000);
  std::vector<std::uint32_t> from(points.size());
  std::iota(from.begin(), from.end(), 0u);
  std::shuffle(from.begin(), from.end(), std::mt19937(3));
  std::vector<Vec3> shuffled;
  for (const std::uint32_t row : from) shuffled.push_back(points[row]);
  Lists expected = neighbor_run(points, {.k = 8}, 8, by(Engine::reference)).lists;
  const Lists found = neighbor_run(shuffled, {.k = 8}, 8, by(Engine::reference)).lists;
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::vector<std::uint32_t> list;
    for (const std::uint32_t j : found[i]) list.push_back(from[j]);
    ASSERT_EQ(list, expected[from[i]]) << i;
  }
}

TEST(Reference, SweepsAlongTheLongestAxisOfAllPointsAlsoWhereASampleSaysOtherwise) {
  std::vector<Vec3> points = random_points(70000, 4);
  for (Vec3& p : points) p.y = 1.499 * p.y;  // a little shorter than along x
  // A point that no sample contains makes y the longest axis.
  std::size_t row = 0;
  for (;; ++row) {
    std::vector<Vec3> changed = points;
    changed[row].y = 3.01;
    const CloudSource<double> source(changed);
    if (survey(source.source, std::nullopt, false).axis == 0) break;
    ASSERT_LT(row, 100u);
  }
  points[row].y = 3.01;
  ASSERT_EQ(bounds_of(points).longest_axis(), 1);
  const std::vector<std::uint32_t> expected = canonical_rows(points);
  for (const Order order : kOrders)
    EXPECT_EQ(neighbor_run(points, {.k = 1}, 1, by(Engine::reference, order, 0)).entered, expected) << text(order);
}

TEST(Reference, TheBuffersTogetherAreTheActiveSet) {
  const Statistics s = neighbor_run(closed_surface(5000), {.k = 8}, 8, by(Engine::reference)).statistics;
  ASSERT_EQ(s.buffers.size(), 6u);
  const char* const names[] = {"read", "knn", "passing", "neighborhood_size", "neighbors", "write"};
  for (std::size_t b = 0; b < 6; ++b) EXPECT_EQ(s.buffers[b].first, names[b]);
  ASSERT_EQ(s.series.size(), 1000u);
  EXPECT_EQ(s.series.back().first, 5000u);
  for (std::size_t i = 0; i < s.series.size(); ++i) {
    std::uint64_t sum = 0;
    for (const auto& [name, series] : s.buffers) {
      ASSERT_EQ(series[i].first, s.series[i].first);
      sum += series[i].second;
    }
    ASSERT_EQ(sum, s.series[i].second) << i;
  }
}

TEST(Reference, RefusesToGrowBeyondItsMemory) {
  // No list of 1,500 neighbours is full before the end, so all points stay in memory.
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[1].second, 5000, 1);
  EngineOptions options = by(Engine::reference);
  options.resources.memory_bytes = 64u << 20;
  try {
    neighbor_run(points, {.k = 1500}, 8, options);
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("raise --memory, or leave out --engine reference"), std::string::npos)
        << error.what();
  }
}

TEST(Reference, ShortListsWithinARadiusFitIntoLittleMemory) {
  const std::vector<Vec3> points = make_cloud(generated("tls"), 40000, 1);
  EngineOptions options = by(Engine::reference, Order::input, 0);
  options.resources.memory_bytes = 100u << 20;
  const NeighborRun run = neighbor_run(points, {.k = Neighborhood::kUnlimited, .radius = 0.3}, 1, options);
  EXPECT_EQ(run.statistics.reference->complete, points.size());
}

/// A slow operator that counts its points.
class Slow final : public LocalOperator {
 public:
  explicit Slow(std::size_t& points) : points_(points) {}
  std::string name() const override { return "slow"; }
  Contract contract() const override { return {{}, {}, {scalar("slow", Type::u8, "1", "")}}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    points_ += in.size();
    std::fill_n(out.column<std::uint8_t>(0).begin(), in.size(), std::uint8_t{1});
  }

 private:
  std::size_t& points_;
};

TEST(Reference, CanBeStoppedWhileAllPointsPassAnOperatorAtOnce) {
  // The first point lies so far beside the others that it is complete only after the last point, and all others wait
  // for it.
  std::vector<Vec3> points = {{0, 999, 0}};
  for (int i = 1; i <= 1000; ++i) points.push_back({double(i), 0, 0});
  std::size_t processed = 0;
  EngineOptions options = by(Engine::reference, Order::input, 0);
  Watching watching([&](const Progress& progress) {
    if (std::string(progress.phase) == "sweeping" && progress.done == points.size()) throw Error("stopped");
  });
  options.observer = &watching;
  const std::vector<double> xyz = xyz_of(points);
  InputCloud cloud = cloud_of(xyz);
  EXPECT_THROW(run_in_memory(cloud, {{.k = 8}, {std::make_shared<Slow>(processed)}, {}}, options), Error);
  EXPECT_LT(processed, points.size());
}

}  // namespace
}  // namespace pointsweep
