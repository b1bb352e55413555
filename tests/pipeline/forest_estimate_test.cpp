// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <random>
#include <string>

#include "pointsweep/connect/forest_edge.h"
#include "pointsweep/pipeline/memory/sample_estimates.h"
#include "pointsweep/sweep/stage_runner.h"

namespace pointsweep {
namespace {

constexpr std::size_t kForestPoints = 6000, kForestNeighbors = 8;

std::vector<Vec3> cloud_of(const std::string& name) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> u(-1, 1);
  const std::map<std::string, std::function<Vec3(std::size_t)>> shapes = {
      {"surface",
       [&](std::size_t) {
         return Vec3{3 * u(random), u(random), 0};
       }},
      {"volume",
       [&](std::size_t) {
         return Vec3{3 * u(random), u(random), u(random)};
       }},
      {"line",
       [&](std::size_t) {
         return Vec3{u(random), 0, 0};
       }},
      {"wall across",
       [&](std::size_t i) {
         return Vec3{i % 3 == 0 ? 0 : 3 * u(random), u(random), u(random)};
       }},
      {"thick wall across",
       [&](std::size_t i) {
         return Vec3{i % 3 == 0 ? 1e-3 * u(random) : 3 * u(random), u(random), u(random)};
       }},
      {"plane across",
       [&](std::size_t) {
         return Vec3{0, u(random), u(random)};
       }},
      {"one place", [&](std::size_t) {
         return Vec3{1, 2, 3};
       }}};
  std::vector<Vec3> points(kForestPoints);
  for (std::size_t i = 0; i < kForestPoints; ++i) points[i] = shapes.at(name)(i);
  return points;
}

/// Returns a survey whose sample has every `step`-th point, with the given dimension.
Survey survey_of(const std::vector<Vec3>& points, std::size_t step, double dimension) {
  Survey survey;
  for (std::size_t i = 0; i < points.size(); i += step) survey.sample.push_back(points[i]);
  survey.dimension = dimension;
  return survey;
}

/// Returns the largest number of points that are open at once, by brute force. A point is open from its own place to
/// the place of the last point that lists it or that it lists.
std::size_t most_open(const std::vector<Vec3>& points) {
  std::vector<PointKey> keys;
  for (std::size_t i = 0; i < points.size(); ++i) keys.push_back({points[i], i});
  std::vector<PointKey> ends = keys;
  const AlongAxis along{0};
  std::vector<std::pair<double, std::size_t>> all(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < points.size(); ++j) all[j] = {j == i ? -1 : distance2(points[i], points[j]), j};
    std::partial_sort(all.begin(), all.begin() + kForestNeighbors + 1, all.end());
    for (std::size_t n = 1; n <= kForestNeighbors; ++n) {
      const std::size_t j = all[n].second;
      ends[i] = std::max(ends[i], keys[j], along);
      ends[j] = std::max(ends[j], keys[i], along);
    }
  }
  std::ranges::sort(keys, along);
  std::ranges::sort(ends, along);
  std::size_t most = 0, closed = 0;
  for (std::size_t opened = 0; opened < keys.size(); ++opened) {
    while (along(ends[closed], keys[opened])) ++closed;
    most = std::max(most, opened + 1 - closed);
  }
  return most;
}

/// The estimate may be too low only by the noise of a sample, so that a forest stays within its memory, and not many
/// times too high, so that no run is refused without need.
TEST(ForestEstimate, IsNearTheMostOpenPointsWhateverTheSample) {
  const std::map<std::string, double> dimensions = {{"surface", 2},     {"volume", 3},       {"line", 1},
                                                    {"wall across", 2}, {"plane across", 2}, {"thick wall across", 2}};
  for (const auto& [name, dimension] : dimensions) {
    const std::vector<Vec3> points = cloud_of(name);
    const auto open = static_cast<double>(most_open(points));
    for (const std::size_t step : {1, 4}) {
      const auto told = static_cast<double>(estimate_open_points(survey_of(points, step, dimension), kForestPoints, 8));
      EXPECT_GE(told, 0.7 * open) << name << ", one of " << step << ": " << open << " are open";
      EXPECT_LE(told, 6 * open + 60) << name << ", one of " << step << ": " << open << " are open";
    }
  }
}

TEST(ForestEstimate, CopiesOfAPointAreNotOpenTogether) {
  EXPECT_LE(estimate_open_points(survey_of(cloud_of("one place"), 2, 1), kForestPoints, 8), kForestPoints / 100);
}

TEST(ForestEstimate, AWallThatIsAThirdOfTheCloudIsOpenAtOnceInACloudOfAnySize) {
  const Survey survey = survey_of(cloud_of("thick wall across"), 1, 2);
  EXPECT_GE(estimate_open_points(survey, 100 * kForestPoints, 8), 100 * kForestPoints / 4);
}

TEST(ForestEstimate, OfSmallCloudsAllPointsMayBeOpen) {
  Survey survey;
  survey.sample = {{0, 0, 0}, {1, 0, 0}};
  EXPECT_EQ(estimate_open_points(survey, 2, 8), 2u);
  EXPECT_EQ(estimate_open_points({}, 0, 8), 0u);
}

/// No bucket has too many points, even on a wall across the axis.
TEST(ForestEstimate, BucketsAreDividedEvenly) {
  for (const char* name : {"surface", "wall across", "plane across"}) {
    const std::vector<Vec3> points = cloud_of(name);
    constexpr std::uint64_t kTimes = 100;  // number of points for which a point of the sample stands
    std::vector<Vec3> begins = places_between_buckets(survey_of(points, 1, 2), kTimes * kForestPoints);
    std::ranges::sort(begins, AlongAxis{0}, [](Vec3 p) { return PointKey{p}; });
    std::map<std::size_t, std::uint64_t> counts;
    for (const Vec3& p : points) {
      const auto next =
          std::ranges::upper_bound(begins, PointKey{p}, AlongAxis{0}, [](Vec3 begin) { return PointKey{begin}; });
      counts[static_cast<std::size_t>(next - begins.begin())] += kTimes;
    }
    for (const auto& [bucket, count] : counts) EXPECT_LE(count, kBucketPoints + kTimes) << name << " " << bucket;
  }
}

}  // namespace
}  // namespace pointsweep
