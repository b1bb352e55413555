// SPDX-License-Identifier: MIT
// The share of a hostile cloud that the window holds at once. Slabs are 3 % of the cloud, so that an even cloud fills
// 16 %. One thread runs each sweep: the peak is then a function of the cloud, while with several threads it also
// depends on which of them ends first, by up to a twentieth here.
#include <gtest/gtest.h>

#include "pointsweep/operators/statistics/neighbor_rows.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/pipeline/in_memory.h"

namespace pointsweep {
namespace {

constexpr std::size_t kSwept = 100000;

Statistics sweep_of(const CloudShape& shape, std::size_t k = 8, std::size_t points = kSwept) {
  const Chain chain{{.k = k}, {std::make_shared<NeighborRows>(k, points, false)}};
  return run_in_memory(make_cloud(shape, points, 3), chain, small_slabs(3000, 256, 1)).statistics;
}

Vec3 on_sphere(std::mt19937_64& r) {
  std::normal_distribution<double> g;
  const Vec3 p{g(r), g(r), 2 * g(r)};
  return (1 / length(p)) * p;
}

TEST(Window, HoldsNoMoreForOutliersThanTheOutliers) {
  const Statistics clean = sweep_of(on_sphere);
  EXPECT_LT(clean.peak_points, kSwept / 5);
  for (const double share : {0.001, 0.01}) {
    for (const double size : {10.0, 1000.0}) {
      SCOPED_TRACE(testing::Message() << share << " of the points in a box " << size << " times larger");
      const Statistics s = sweep_of([&](auto& r) {
        return uniform(r) < share ? size * Vec3{2 * uniform(r) - 1, 2 * uniform(r) - 1, 2 * uniform(r) - 1}
                                  : on_sphere(r);
      });
      EXPECT_LT(s.peak_points, 3 * clean.peak_points / 2 + static_cast<std::uint64_t>(share * kSwept));
      EXPECT_LT(s.recalled, static_cast<std::uint64_t>(share * kSwept) + 60);
    }
  }
}

TEST(Window, HoldsNoMoreForAWallAcrossTheAxis) {
  for (const double noise : {0.0, 1e-4, 1e-3}) {
    SCOPED_TRACE(noise);
    constexpr std::size_t kPoints = 4 * kSwept;  // in fewer points, the cells beside the floor are most of the wall
    const Statistics s = sweep_of(
        [&](auto& r) {
          return uniform(r) < 0.5 ? Vec3{4 + noise * uniform(r), uniform(r), uniform(r)}
                                  : Vec3{10 * uniform(r), uniform(r), 0};
        },
        8, kPoints);
    EXPECT_LT(s.peak_points, kPoints / 4);
    EXPECT_LT(s.recalled, kPoints / 200);
  }
}

/// Slabs are so thin that the neighbourhood of a point in noise reaches through several of them.
TEST(Window, LeavesHardlyAPointOfANoisySurfaceToTheRecall) {
  const auto noisy = [](auto& r) {
    const Vec3 p = on_sphere(r);
    return (1 + 0.02 * std::normal_distribution<double>()(r)) * p;  // neighbours are 0.01 apart
  };
  const Chain chain{{.k = 8}, {std::make_shared<NeighborRows>(8, kSwept, false)}};
  std::uint64_t recalled = 0;
  for (const std::uint64_t seed : {3, 4, 5}) {
    const Statistics s = run_in_memory(make_cloud(noisy, kSwept, seed), chain, small_slabs(300, 1024, 1)).statistics;
    EXPECT_LT(s.peak_points, kSwept / 3);
    recalled += s.recalled;
  }
  EXPECT_LT(recalled, 10u);
}

TEST(Window, LetsCopiesOfOnePointPass) {
  for (const std::size_t k : {8, 100}) {
    SCOPED_TRACE(k);
    const Statistics s = sweep_of([](auto& r) { return uniform(r) < 0.9 ? Vec3{0, 0, 1} : on_sphere(r); }, k);
    EXPECT_LT(s.peak_points, kSwept / 4);
    EXPECT_LT(s.recalled, kSwept / 200);
  }
}

TEST(Window, FollowsADensityThatFallsOverFourDecades) {
  const Statistics s = sweep_of([](auto& r) {
    const double d = std::pow(10, 4 * uniform(r) - 4), a = 2 * M_PI * uniform(r);
    return Vec3{d * std::cos(a), d * std::sin(a), 0.001 * d * uniform(r)};
  });
  EXPECT_LT(s.peak_points, kSwept / 3);
  EXPECT_LT(s.recalled, kSwept / 200);
}

}  // namespace
}  // namespace pointsweep
