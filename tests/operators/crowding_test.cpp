// SPDX-License-Identifier: MIT
/// Radius outliers, densities and local outlier factors of points whose values are calculated by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/pipeline/in_memory.h"
#include "tests/pipeline/refusal.h"

namespace pointsweep {
namespace {

RunResult made(const std::vector<Vec3>& points, const std::string& pipeline) {
  return run_in_memory(points, build_chain(parse_pipeline(pipeline), Facts{}), {});
}

/// Points at 0, 1, 2, 3 and 10 on a line.
const std::vector<Vec3> kLine = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {10, 0, 0}};

TEST(Crowding, ANeighbourAtTheRadiusCounts) {
  using Values = std::vector<double>;
  EXPECT_EQ(made(kLine, "knn(k=2) | ror(radius=1, min_neighbors=2)").field("outlier"), (Values{1, 0, 0, 1, 1}));
  EXPECT_EQ(made(kLine, "knn(radius=2) | ror(radius=1, min_neighbors=1)").field("outlier"), (Values{0, 0, 0, 0, 1}));
  EXPECT_EQ(made(kLine, "knn(k=3) | ror(radius=7, min_neighbors=1)").field("outlier"), Values(5, 0));
}

TEST(Crowding, DensitiesAreCountsOverDiscsAndBalls) {
  const double pi = std::numbers::pi;
  const RunResult nearest = made(kLine, "knn(k=2) | density");
  EXPECT_NEAR(nearest.field("surface_density")[0], 2 / (pi * 4), 1e-7);
  EXPECT_NEAR(nearest.field("volume_density")[0], 2 / (4 * pi / 3 * 8), 1e-8);
  EXPECT_NEAR(nearest.field("surface_density")[4], 2 / (pi * 64), 1e-9);
  const RunResult within = made(kLine, "knn(radius=2) | density(radius=1)");
  EXPECT_NEAR(within.field("surface_density")[1], 3 / pi, 1e-7);
  EXPECT_NEAR(within.field("volume_density")[4], 1 / (4 * pi / 3), 1e-7);
  const RunResult place = made(std::vector<Vec3>(4, {1, 1, 1}), "knn(k=2) | density");
  EXPECT_EQ(place.field("surface_density"), std::vector<double>(4, 0));
  EXPECT_EQ(place.statistics.degenerate, 4u);
}

TEST(Crowding, LocalOutlierFactorsOfALineAreThoseOfTheDefinition) {
  const RunResult got = made(kLine, "knn(k=2) | lof");
  EXPECT_EQ(got.field("k_distance"), (std::vector<double>{2, 1, 1, 2, 8}));
  // Reachability distances: 1 and 2 for point 0; 2 and 1 for point 1; 1 and 2 for points 2 and 3; 7 and 8 for point 10.
  const std::vector<double> density = got.field("reachability_density"), lof = got.field("lof");
  for (int i = 0; i < 4; ++i) EXPECT_DOUBLE_EQ(density[i], 2 / 3.0) << i;
  EXPECT_DOUBLE_EQ(density[4], 2 / 15.0);
  EXPECT_DOUBLE_EQ(lof[0], 1);
  EXPECT_DOUBLE_EQ(lof[4], 5);
}

TEST(Crowding, CopiesOfOnePointAreAsDenseAsEachOther) {
  std::vector<Vec3> points(4, {0, 0, 0});
  points.push_back({1, 0, 0});
  const RunResult got = made(points, "knn(k=2) | lof");
  const std::vector<double> density = got.field("reachability_density"), lof = got.field("lof");
  EXPECT_TRUE(std::isinf(density[0]));
  EXPECT_EQ(lof[0], 1);
  EXPECT_EQ(density[4], 1);
  EXPECT_TRUE(std::isinf(lof[4]));
  const RunResult alone = made({{0, 0, 0}}, "knn(k=2) | lof");
  EXPECT_TRUE(std::isnan(alone.field("lof")[0]));
}

TEST(Crowding, NeighborhoodsThatDoNotHoldWhatIsCountedAreRefused) {
  const auto refused = [](const std::string& pipeline) {
    return refusal([&] { build_chain(parse_pipeline(pipeline), Facts{}); });
  };
  EXPECT_NE(refused("knn(k=3) | ror(radius=1, min_neighbors=4)").find("needs more neighbours than the 3"),
            std::string::npos);
  EXPECT_NE(refused("knn(radius=0.5) | ror(radius=1)").find("those within 0.5 are known"), std::string::npos);
  EXPECT_NE(refused("knn(k=20, adaptive=eigenentropy) | ror(radius=1)").find("each point keeps"), std::string::npos);
  EXPECT_NE(refused("knn(k=20) | density(radius=1)").find("knn(radius=1)"), std::string::npos);
  EXPECT_EQ(refused("knn(k=4) | reneighbor(radius=2) | density(radius=1)"), "");
  EXPECT_NE(refused("knn(radius=2) | reneighbor(k=3) | density(radius=1)"), "");
}

}  // namespace
}  // namespace pointsweep
