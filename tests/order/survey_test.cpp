// SPDX-License-Identifier: MIT
#include "pointsweep/order/survey.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "pointsweep/error.h"
#include "tests/order/cloud_source.h"

namespace pointsweep {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

TEST(Survey, OfASmallCloudSeesEveryPoint) {
  const std::vector<Vec3> points = random_points(5000, 1);
  const CloudSource<double> cloud(points);
  const Survey look = survey(cloud.source, {}, false);
  EXPECT_EQ(look.sample, points);
  EXPECT_TRUE(look.exact);
  Box box;
  for (const Vec3& p : points) box.include(p);
  EXPECT_EQ(look.bounds, box);
}

TEST(Survey, SamplesAllPartsOfALargeCloudOnceInAscendingRow) {
  std::vector<Vec3> points(300000);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].x = static_cast<double>(i);
  const CloudSource<double> cloud(points);
  const Survey look = survey(cloud.source, {}, false);
  EXPECT_EQ(look.sample.size(), 65536u);
  EXPECT_FALSE(look.exact);
  for (std::size_t i = 1; i < look.sample.size(); ++i) {
    ASSERT_GT(look.sample[i].x, look.sample[i - 1].x);
    ASSERT_LT(look.sample[i].x, look.sample[i - 1].x + 1000);
  }
  EXPECT_LT(look.sample.front().x, 1000);
  EXPECT_GT(look.sample.back().x, 299000);
}

/// Two scanners take turns of 128 rows. Each of the 1,024 runs of the sample has 128 of 256 rows.
TEST(Survey, SeesBothOfTwoInterleavedScannersWhateverTheirPeriod) {
  std::vector<Vec3> points(1024 * 256);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].x = i % 256 < 128 ? 0 : 1;
  const CloudSource<float> cloud(points);
  const Survey look = survey(cloud.source, {}, false);
  const auto seconds = std::ranges::count_if(look.sample, [](const Vec3& p) { return p.x == 1; });
  EXPECT_NEAR(static_cast<double>(seconds) / static_cast<double>(look.sample.size()), 0.5, 0.05);
}

TEST(Survey, HasTheSameSampleWhenItIsExactAndTheBoundsOfAllPoints) {
  std::vector<Vec3> points = random_points(200003, 2);
  points[77777] = {0, 0, 1e9};
  points[33] = {kNotANumber, 0, 1e12};
  const CloudSource<double> cloud(points);
  const Survey quick = survey(cloud.source, {}, false), exact = survey(cloud.source, {}, true);
  EXPECT_EQ(quick.sample, exact.sample);
  EXPECT_TRUE(exact.exact);
  EXPECT_EQ(exact.bounds.hi.z, 1e9);
  EXPECT_EQ(exact.axis, 2);
}

TEST(Survey, TakesTheLongestAxisUnlessOneIsGiven) {
  const CloudSource<float> cloud(random_points(1000, 3));
  EXPECT_EQ(survey(cloud.source, {}, false).axis, 0);
  EXPECT_EQ(survey(cloud.source, 2, false).axis, 2);
}

TEST(Survey, LeavesOutPointsWithoutAPlace) {
  std::vector<Vec3> points = random_points(1000, 4);
  for (std::size_t i = 0; i < points.size(); i += 2) points[i].y = kNotANumber;
  const CloudSource<float> cloud(points);
  const Survey look = survey(cloud.source, {}, false);
  EXPECT_EQ(look.sample.size(), 500u);
  EXPECT_TRUE(is_finite(look.bounds.lo) && is_finite(look.bounds.hi));
}

TEST(Survey, OfNothingIsEmpty) {
  const CloudSource<float> cloud({});
  const Survey look = survey(cloud.source, {}, true);
  EXPECT_TRUE(look.sample.empty());
  EXPECT_TRUE(look.bounds.empty());
  EXPECT_EQ(look.dimension, 2);
}

TEST(Survey, RefusesASourceThatEndsEarly) {
  CloudSource<float> cloud(random_points(1000, 5));
  PointSource shortened = cloud.source;
  shortened.count = 1001;
  shortened.read = [&](std::uint64_t row, std::span<std::byte> out) {
    return row < 1000 ? cloud.source.read(row, out) : 0;
  };
  EXPECT_THROW(survey(shortened, {}, false), Error);
}

TEST(BoxCountingDimension, OfLinesSurfacesAndVolumes) {
  std::vector<Vec3> line = random_points(60000, 6), plane = line, sphere = line, volume = line;
  for (Vec3& p : line) p = {p.x, 0.3 * p.x, -p.x};
  for (Vec3& p : plane) p = {p.x, p.y, 0.2 * p.x + 0.1 * p.y};
  std::mt19937_64 random(60);
  std::normal_distribution<double> normal;
  for (Vec3& p : sphere) {
    p = {normal(random), normal(random), normal(random)};
    p = (1 / length(p)) * p;
  }
  EXPECT_NEAR(box_counting_dimension(line), 1, 0.15);
  EXPECT_NEAR(box_counting_dimension(plane), 2, 0.2);
  EXPECT_NEAR(box_counting_dimension(sphere), 2, 0.25);
  EXPECT_NEAR(box_counting_dimension(volume), 3, 0.25);
}

TEST(BoxCountingDimension, IsNotMisledByOutliers) {
  std::vector<Vec3> plane = random_points(60000, 7);
  for (Vec3& p : plane) p.z = 0;
  for (std::size_t i = 0; i < plane.size(); i += 1000) plane[i] = 1e6 * plane[i];
  EXPECT_NEAR(box_counting_dimension(plane), 2, 0.2);
}

TEST(BoxCountingDimension, OfTooFewOrEqualPointsIsUndecided) {
  EXPECT_EQ(box_counting_dimension(random_points(10, 8)), 2);
  EXPECT_EQ(box_counting_dimension(std::vector<Vec3>(1000, Vec3{1, 2, 3})), 2);
}

TEST(RecommendedSlabPoints, KeepSlabsThick) {
  EXPECT_EQ(recommended_slab_points(0, 2), 16384u);
  EXPECT_EQ(recommended_slab_points(1000, 3), 16384u);
  EXPECT_NEAR(static_cast<double>(recommended_slab_points(100'000'000, 2)), 160000, 1);
  EXPECT_NEAR(static_cast<double>(recommended_slab_points(1'000'000'000, 3)), 6e6, 10);
  EXPECT_EQ(recommended_slab_points(100'000'000, 1.5), recommended_slab_points(100'000'000, 2));
}

}  // namespace
}  // namespace pointsweep
