// SPDX-License-Identifier: MIT
/// Facts that a run records on request, without a change of its results.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pointsweep/operators/surface/curvature.h"
#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/sweep/sweep.h"
#include "tests/formats/temporary_folder.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/pipeline/in_memory.h"
#include "tests/support/brute_force.h"

namespace pointsweep {
namespace {

constexpr std::size_t kObserved = 8;

Chain curvatures() {
  return {{.k = kObserved, .radius = std::numeric_limits<double>::infinity()},
          {std::make_shared<Normals>(), std::make_shared<Curvature>()}};
}

EngineOptions observed(std::uint64_t slab_points, unsigned threads) {
  EngineOptions options;
  options.slab_points = slab_points;
  options.cell_points = 64;
  options.resources.threads = threads;
  options.resources.memory_bytes = 1ull << 30;
  options.count_distances = true;
  return options;
}

TEST(Observation, DistancesAreThoseOfBruteForceForAnySlabsAndThreads) {
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, 1500, 5);
    const auto lists = brute_force_neighbors(points, kObserved);
    for (const auto& [slab, threads] : {std::pair<std::uint64_t, unsigned>{64, 2}, {400, 1}, {100000, 3}}) {
      SCOPED_TRACE(name + ", slabs of " + std::to_string(slab));
      const auto bins = run_in_memory(points, curvatures(), observed(slab, threads)).statistics.neighbor_distances;
      std::uint64_t counted = 0;
      for (const DistanceBin& bin : bins) {
        std::uint64_t nearest = 0, farthest = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
          if (lists[i].empty()) continue;
          // The edges of the bins are exact for squared distances.
          const auto inside = [&](std::uint32_t row) {
            const double d2 = distance2(points[row], points[i]);
            return d2 >= bin.from * bin.from * (1 - 1e-12) && std::sqrt(d2) < bin.to;
          };
          nearest += inside(lists[i].front());
          farthest += inside(lists[i].back());
        }
        EXPECT_EQ(bin.nearest, nearest) << bin.from;
        EXPECT_EQ(bin.farthest, farthest) << bin.from;
        counted += bin.nearest;
      }
      std::uint64_t expected = 0;
      for (const auto& list : lists) expected += !list.empty();
      EXPECT_EQ(counted, expected);
    }
  }
}

TEST(Observation, NothingIsCountedUnlessAskedFor) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes().front().second, 500, 5);
  EngineOptions options = observed(100, 1);
  options.count_distances = false;
  EXPECT_TRUE(run_in_memory(points, curvatures(), options).statistics.neighbor_distances.empty());
}

TEST(Observation, HalfWayHalfOfThePointsHaveBeenReadAndResultsAreTheSame) {
  const TemporaryFolder folder;
  std::vector<Vec3> points;
  for (int i = 0; i < 20000; ++i) points.push_back({i * 1e-3, (i * 7919 % 1009) * 1e-4, (i * 104729 % 1013) * 1e-4});
  EngineOptions options = observed(500, 2);
  options.axis = 0;
  const RunResult plain = run_in_memory(points, curvatures(), options);
  options.half_way_states = folder / "states.npy";
  const RunResult watched = run_in_memory(points, curvatures(), options);
  EXPECT_EQ(watched.records, plain.records);
  const std::string file = contents(folder / "states.npy");
  ASSERT_EQ(file.size(), 128 + points.size());
  const auto state_of = [&](std::size_t row) { return static_cast<PointState>(file[128 + row]); };
  std::size_t read = 0;
  while (read < points.size() && state_of(read) != PointState::unread) ++read;
  EXPECT_GE(read, points.size() / 2);
  EXPECT_LE(read, points.size() / 2 + 1000) << "no more than a slab too many";
  for (std::size_t row = read; row < points.size(); ++row) ASSERT_EQ(state_of(row), PointState::unread) << row;
  for (const auto state : {PointState::waiting, PointState::gone}) {
    EXPECT_NE(std::count(file.begin() + 128, file.end(), static_cast<char>(state)), 0) << static_cast<int>(state);
  }
}

}  // namespace
}  // namespace pointsweep
