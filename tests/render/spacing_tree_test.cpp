// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pointsweep/render/point_shape.h"

namespace pointsweep {
namespace {

/// Returns `n` random points of a square in the plane z = x / 2, with x from `left` on.
std::vector<Vec3> slope(std::size_t n, double left) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = left + unit(random);
    points.push_back({x, unit(random), x / 2});
  }
  return points;
}

TEST(SpacingTree, FindsTheSpacingOfASurface) {
  const SpacingTree tree(slope(10000, 0), 10000);
  double sum = 0;
  const auto places = slope(500, 0);
  for (const Vec3 p : places) sum += tree.spacing(p);
  EXPECT_NEAR(sum / 500, 0.0106, 0.002);
}

TEST(SpacingTree, ASampleStandsForAllPoints) {
  const SpacingTree tree(slope(10000, 0), 1000000);
  EXPECT_NEAR(tree.spacing({0.5, 0.5, 0.25}), 0.00106, 0.0005);
}

TEST(SpacingTree, DenseAndSparsePartsDiffer) {
  std::vector<Vec3> points = slope(20000, 0), sparse = slope(200, 5);
  points.insert(points.end(), sparse.begin(), sparse.end());
  const SpacingTree tree(points, points.size());
  EXPECT_GT(tree.spacing({5.5, 0.5, 2.75}), 5 * tree.spacing({0.5, 0.5, 0.25}));
}

/// The cloud has rings of a scanner on level ground: points are 0.02 apart, rings 1.
TEST(SpacingTree, IsAtMostTwiceTheDistanceToTheNextPoint) {
  std::vector<Vec3> rings;
  for (int ring = 1; ring <= 20; ++ring)
    for (double angle = 0; angle < 6.283; angle += 0.02 / ring)
      rings.push_back({ring * std::cos(angle), ring * std::sin(angle), 0});
  const SpacingTree tree(rings, rings.size());
  for (const Vec3 p : rings) ASSERT_LE(tree.spacing(p), 2 * 0.0201);
}

TEST(SpacingTree, PointsThatAreThereTwiceCountOnce) {
  std::vector<Vec3> once = slope(10000, 0), twice = once;
  twice.insert(twice.end(), once.begin(), once.end());
  EXPECT_GT(SpacingTree(twice, twice.size()).spacing({0.5, 0.5, 0.25}), 0.004);
}

TEST(SpacingTree, FewOrEqualOrNoPointsHaveNone) {
  EXPECT_EQ(SpacingTree({}, 0).spacing({1, 2, 3}), 0);
  EXPECT_EQ(SpacingTree({{1, 1, 1}}, 1).spacing({1, 1, 1}), 0);
  EXPECT_EQ(SpacingTree(std::vector<Vec3>(1000, {1, 1, 1}), 1000).spacing({1, 1, 1}), 0);
}

}  // namespace
}  // namespace pointsweep
