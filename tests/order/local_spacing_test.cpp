// SPDX-License-Identifier: MIT
#include "pointsweep/order/local_spacing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/order/cloud_source.h"

namespace pointsweep {
namespace {

constexpr std::size_t kSample = 20000;

std::vector<Vec3> sphere(std::size_t n) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::vector<Vec3> points(n);
  for (Vec3& p : points) {
    p = {normal(random), normal(random), normal(random)};
    p = (1 / length(p)) * p;
  }
  return points;
}

/// Returns a sphere whose first points, one in a hundred, are anywhere in a box of `size` times the size of the sphere.
std::vector<Vec3> sphere_with_outliers(double size) {
  std::vector<Vec3> points = sphere(kSample);
  const std::vector<Vec3> anywhere = random_points(kSample / 100, 3);  // in [-3, 3] x [-2, 2] x [-1, 1]
  for (std::size_t i = 0; i < anywhere.size(); ++i)
    points[i] = size * Vec3{anywhere[i].x / 3, anywhere[i].y / 2, anywhere[i].z};
  return points;
}

TEST(LocalSpacing, OfAnEvenSurfaceIsRightWithinAFactorOfTwo) {
  constexpr std::uint64_t kPoints = 1'000'000;
  const LocalSpacing spacing(sphere(kSample), kPoints, 2);
  std::vector<double> sorted = spacing.at_sample();
  ASSERT_EQ(sorted.size(), kSample);
  std::ranges::sort(sorted);
  const double expected = std::sqrt(4 * std::numbers::pi / kPoints);
  for (const std::size_t at : {kSample / 10, kSample / 2, kSample * 9 / 10}) {
    EXPECT_GT(sorted[at], expected / 2.5);
    EXPECT_LT(sorted[at], expected * 2.5);
  }
}

TEST(LocalSpacing, FollowsDensityThatFalls) {
  std::vector<Vec3> points = random_points(kSample, 1);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].z = 0;
  for (std::size_t i = 0; i < points.size() / 2; ++i) points[i] = {points[i].x / 30 + 10, points[i].y / 30, 0};
  const LocalSpacing spacing(points, kSample, 2);
  const auto middle = static_cast<std::ptrdiff_t>(kSample / 4);
  std::vector<double> dense(spacing.at_sample().begin(), spacing.at_sample().begin() + 2 * middle);
  std::vector<double> sparse(spacing.at_sample().begin() + 2 * middle, spacing.at_sample().end());
  std::ranges::nth_element(dense, dense.begin() + middle);
  std::ranges::nth_element(sparse, sparse.begin() + middle);
  EXPECT_NEAR(std::log2(sparse[kSample / 4] / dense[kSample / 4]), std::log2(30), 1);
}

TEST(LocalSpacing, AnEvenCloudHasNoSparsePlaces) {
  EXPECT_FALSE(LocalSpacing(sphere(kSample), kSample, 2).has_sparse_places());
  EXPECT_FALSE(LocalSpacing(random_points(kSample, 1), kSample, 3).has_sparse_places());
}

TEST(LocalSpacing, AnEvenCubeHasNoneAlongItsEdges) {
  for (const std::size_t sample : {kSample, 4 * kSample})
    for (const unsigned seed : {1u, 2u, 3u, 4u}) {
      std::vector<Vec3> points = random_points(sample, seed);
      for (Vec3& p : points) p = {p.x / 3, p.y / 2, p.z};
      EXPECT_FALSE(LocalSpacing(points, 20 * sample, 3).has_sparse_places()) << sample << ", " << seed;
    }
}

TEST(LocalSpacing, OutliersAreInSparsePlacesAndTheSurfaceIsNot) {
  for (const double size : {10.0, 1000.0, 1e9}) {
    SCOPED_TRACE(size);
    const std::vector<Vec3> points = sphere_with_outliers(size);
    const LocalSpacing spacing(points, kSample, 2);
    ASSERT_TRUE(spacing.has_sparse_places());
    std::size_t outliers = 0, surface = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
      (i < kSample / 100 ? outliers : surface) += spacing.is_sparse(points[i]);
    EXPECT_GT(outliers, kSample / 100 * 9 / 10);
    EXPECT_LT(surface, kSample / 1000);
  }
}

TEST(LocalSpacing, OfTooLittleSaysNothing) {
  const std::vector<Vec3> one_place(1000, Vec3{1, 2, 3});
  for (const LocalSpacing& spacing :
       {LocalSpacing(), LocalSpacing(random_points(5, 1), 5, 2), LocalSpacing(one_place, 1000, 2)}) {
    EXPECT_TRUE(spacing.at_sample().empty());
    EXPECT_FALSE(spacing.has_sparse_places());
    EXPECT_FALSE(spacing.is_sparse({1e300, 0, 0}));
  }
}

TEST(LocalSpacing, TakesAnyFinitePlace) {
  const LocalSpacing spacing(sphere_with_outliers(10), kSample, 2);
  constexpr double kMax = std::numeric_limits<double>::max();
  for (const Vec3 far : {Vec3{kMax, -kMax, kMax}, Vec3{-kMax, 0, 0}, Vec3{0, 1e30, 0}})
    EXPECT_TRUE(spacing.is_sparse(far));
}

}  // namespace
}  // namespace pointsweep
