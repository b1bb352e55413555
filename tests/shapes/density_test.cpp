// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/shapes/shapes.h"

namespace pointsweep {
namespace {

/// Returns the mean of `value` over 200,000 points of a shape.
template <class F>
double mean(std::string_view shape, F value) {
  const auto points = points_of(shape, 200'000);
  double sum = 0;
  for (const SurfacePoint& p : points) sum += value(p.position);
  return sum / static_cast<double>(points.size());
}

TEST(Density, OfSimpleShapesIsUniform) {
  // Second moments known in closed form; the standard error of each mean is about a tenth of the tolerance.
  EXPECT_NEAR(mean("plane", [](Vec3 p) { return p.x * p.x + p.y * p.y; }), 1.0 / 6, 2e-3);
  EXPECT_NEAR(mean("plane", [](Vec3 p) { return p.x * p.y; }), 0, 2e-3);
  EXPECT_NEAR(mean("sphere", [](Vec3 p) { return p.z * p.z; }), 1.0 / 3, 6e-3);
  EXPECT_NEAR(mean("sphere", [](Vec3 p) { return p.x * p.x; }), 1.0 / 3, 6e-3);
  EXPECT_NEAR(mean("cylinder", [](Vec3 p) { return p.z * p.z; }), 1.0 / 3, 6e-3);
  EXPECT_NEAR(mean("torus", [](Vec3 p) { return std::hypot(p.x, p.y); }), 1 + 0.3 * 0.3 / 2, 4e-3);
  EXPECT_NEAR(mean("volume", [](Vec3 p) { return p.x * p.y * p.z; }), 1.0 / 8, 3e-3);
}

TEST(Density, OfTheStatueIsNearlyUniform) {
  const auto cloud = points_of("statue", 60'000);
  std::vector<double> area;  // square of the radius that holds the 32 nearest neighbours
  for (std::size_t i = 0; i < 200; ++i) {
    std::vector<double> d2;
    for (const SurfacePoint& q : cloud) d2.push_back(distance2(q.position, cloud[i].position));
    std::nth_element(d2.begin(), d2.begin() + 32, d2.end());
    area.push_back(d2[32]);
  }
  std::sort(area.begin(), area.end());
  // A uniform sample has a ratio of about 1.8. The surface sampled uniformly by direction would have a ratio of 4 or
  // more.
  EXPECT_LT(area[190] / area[10], 2.2);
}

TEST(Density, OfTheTerrainIsUniformInThePlanWithFewPointsOnWalls) {
  const auto cloud = points_of("terrain", 100'000);
  int walls = 0;
  std::vector<int> tiles(25);
  for (const SurfacePoint& p : cloud) {
    if (p.normal.z == 0) ++walls;
    if (p.normal.z > 0)
      ++tiles[static_cast<std::size_t>(p.position.x / 200) * 5 + static_cast<std::size_t>(p.position.y / 200)];
  }
  EXPECT_NEAR(walls, 2000, 5 * std::sqrt(2000));
  for (const int tile : tiles) EXPECT_NEAR(tile, 3920, 5 * std::sqrt(3920));
}

TEST(Density, OfATerrestrialScanFallsWithTheSquareOfTheDistance) {
  // On the ground the angle of incidence adds a third power of the range, so the number of rays between ranges a and b
  // is proportional to 1/a - 1/b.
  const auto cloud = points_of("tls", 400'000);
  const auto between = [&](double a, double b) {
    return static_cast<double>(std::count_if(cloud.begin(), cloud.end(), [&](const SurfacePoint& p) {
      return p.normal.z == 1 && length(p.position) > a && length(p.position) < b;
    }));
  };
  const double near = between(2, 2.5), far = between(3, 3.75);
  EXPECT_NEAR(near / far, 1.5, 0.05);
  EXPECT_GT(far, 10'000);
}

TEST(Density, OfATerrestrialScanSpansFourDecades) {
  double nearest = 1e9, farthest = 0;
  for (const SurfacePoint& p : points_of("tls", 400'000)) {
    nearest = std::min(nearest, length(p.position));
    farthest = std::max(farthest, length(p.position));
  }
  EXPECT_NEAR(nearest, 1.7 / std::sqrt(0.75), 0.01);  // steepest ray, 60 degrees
  EXPECT_LE(farthest, 100);
  EXPECT_GT(std::pow(farthest / nearest, 3), 1e4);
}

}  // namespace
}  // namespace pointsweep
