// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "pointsweep/error.h"
#include "tests/shapes/shapes.h"

namespace pointsweep {
namespace {

TEST(Shapes, AreFoundByTheirNames) {
  std::set<std::string> names;
  for (const auto& shape : all_shapes()) {
    EXPECT_EQ(create_shape(shape->name())->name(), shape->name());
    EXPECT_FALSE(shape->meaning().empty());
    names.insert(shape->name());
  }
  EXPECT_EQ(names,
            (std::set<std::string>{"cylinder", "plane", "sphere", "statue", "terrain", "tls", "torus", "volume"}));
}

TEST(Shapes, AnUnknownNameIsAnErrorThatListsTheKnownOnes) {
  try {
    create_shape("bunny");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("'bunny'; choose one of plane, sphere"), std::string::npos)
        << error.what();
  }
}

TEST(Shapes, PointsLieInTheirBounds) {
  for (const auto& shape : all_shapes()) {
    const Box bounds = shape->bounds();
    Box seen;
    for (const SurfacePoint& p : points_of(shape->name(), 50'000)) seen.include(p.position);
    Box both = bounds;
    both.include(seen);
    EXPECT_EQ(both, bounds) << shape->name();
    EXPECT_GT(seen.diagonal(), 0.5 * bounds.diagonal()) << shape->name();
  }
}

TEST(Shapes, PointsLieOnTheirSurfaceAndNormalsAreItsGradient) {
  for (const auto& [p, n] : points_of("plane", 10'000)) {
    EXPECT_EQ(p.z, 0);
    EXPECT_EQ(n, (Vec3{0, 0, 1}));
  }
  for (const auto& [p, n] : points_of("sphere", 10'000)) {
    EXPECT_NEAR(length(p), 1, 1e-14);
    EXPECT_LT(length(n - p), 1e-7);
  }
  for (const auto& [p, n] : points_of("cylinder", 10'000)) {
    EXPECT_NEAR(std::hypot(p.x, p.y), 0.5, 1e-14);
    EXPECT_LT(length(n - Vec3{2 * p.x, 2 * p.y, 0}), 1e-7);
  }
  for (const auto& [p, n] : points_of("torus", 10'000)) {
    const double ring = std::hypot(p.x, p.y);
    const Vec3 from_ring = p - Vec3{p.x / ring, p.y / ring, 0};
    EXPECT_NEAR(length(from_ring), 0.3, 1e-14);
    EXPECT_LT(length(n - (1 / 0.3) * from_ring), 1e-6);
  }
}

TEST(Shapes, NormalsHaveUnitLength) {
  for (const auto& shape : all_shapes()) {
    const double expected = shape->has_normals() ? 1 : 0;
    for (const SurfacePoint& p : points_of(shape->name(), 10'000))
      ASSERT_NEAR(length(p.normal), expected, 1e-6) << shape->name();
  }
}

/// Returns the angle in radians by which the nearest neighbours of point i are tilted against its normal: 0 on a flat
/// or evenly curved piece.
double tilt(const std::vector<SurfacePoint>& cloud, std::size_t i, std::size_t neighbors) {
  std::vector<std::pair<double, std::size_t>> by_distance;
  for (std::size_t j = 0; j < cloud.size(); ++j)
    if (j != i) by_distance.emplace_back(distance2(cloud[j].position, cloud[i].position), j);
  std::nth_element(by_distance.begin(), by_distance.begin() + static_cast<std::ptrdiff_t>(neighbors),
                   by_distance.end());
  Vec3 sum;
  double weight = 0;
  for (std::size_t j = 0; j < neighbors; ++j) {
    const Vec3 d = cloud[by_distance[j].second].position - cloud[i].position;
    const double above = dot(d, cloud[i].normal);
    sum = sum + above * (d - above * cloud[i].normal);
    weight += 0.5 * dot(d, d);
  }
  return length(sum) / weight;
}

TEST(Shapes, NeighborsLieAcrossTheNormalExceptAtEdges) {
  for (const auto& shape : all_shapes()) {
    if (!shape->has_normals()) continue;
    const auto cloud = points_of(shape->name(), 60'000);
    int upright = 0;
    for (std::size_t i = 0; i < 100; ++i) upright += tilt(cloud, i, 24) < 0.05 ? 1 : 0;
    EXPECT_GE(upright, 70) << shape->name();
  }
}

}  // namespace
}  // namespace pointsweep
