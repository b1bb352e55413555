// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "pointsweep/error.h"
#include "pointsweep/operators.h"
#include "tests/operators/chosen.h"
#include "tests/support/brute_force.h"

namespace pointsweep {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();

/// Points at whole numbers of a line, each with its six nearest: inside the line at distances 1, 1, 2, 2, 3, 3.
struct Line {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> lists;
  Line() {
    for (int x = 0; x < 20; ++x) points.push_back({double(x), 0, 0});
    lists = brute_force_neighbors(points, 6);
  }
  /// Returns the number of neighbours that point 10 keeps.
  std::uint32_t kept(const AttributeLimits& limits, const std::vector<double>& values) const {
    std::vector<std::vector<double>> attributes;
    for (const double value : values) attributes.emplace_back(points.size(), value);
    return chosen(*operators::limits_from_attributes(limits), points, lists, attributes)[10];
  }
};

TEST(LimitsFromAttributes, KIsTheWholePartOfTheValueAndAtMostWhatWasFound) {
  const Line line;
  for (const auto& [value, kept] :
       {std::pair{4.0, 4u}, {4.99, 4u}, {1.0, 1u}, {5.0, 5u}, {6.0, 6u}, {7.0, 6u}, {1e300, 6u}, {kInf, 6u}})
    EXPECT_EQ(line.kept({.k = "k"}, {value}), kept) << value;
}

TEST(LimitsFromAttributes, TheRadiusIsInclusive) {
  const Line line;
  for (const auto& [value, kept] :
       {std::pair{2.0, 4u}, {1.999, 2u}, {0.5, 0u}, {1.0, 2u}, {3.0, 6u}, {99.0, 6u}, {kInf, 6u}})
    EXPECT_EQ(line.kept({.radius = "r"}, {value}), kept) << value;
}

TEST(LimitsFromAttributes, ValuesThatAreNoSizeAllowNoNeighbors) {
  const Line line;
  for (const double value : {kNan, -1.0, -kInf}) {
    EXPECT_EQ(line.kept({.k = "k"}, {value}), 0u) << value;
    EXPECT_EQ(line.kept({.radius = "r"}, {value}), 0u) << value;
  }
  EXPECT_EQ(line.kept({.k = "k"}, {0.9}), 0u);
}

TEST(LimitsFromAttributes, ARadiusOfZeroKeepsThePointsInTheSamePlace) {
  const std::vector<Vec3> points{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 4}};
  const auto lists = brute_force_neighbors(points, 3);
  EXPECT_EQ(chosen(*operators::limits_from_attributes({.radius = "r"}), points, lists, {{0, 0, 0, 0}}),
            (std::vector<std::uint32_t>{2, 2, 2, 0}));
}

/// The radius is the rounded root of a squared distance. The square of the rounded root may be less than the squared
/// distance.
TEST(LimitsFromAttributes, ASquaredDistanceIsComparedWithTheRoundedSquareOfTheRadius) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec3> points(2000);
  for (Vec3& p : points) p = {uniform(random), uniform(random), uniform(random)};
  const auto lists = brute_force_neighbors(points, 7);
  std::vector<double> radius(points.size());
  std::vector<std::uint32_t> expected(points.size(), 7);
  std::size_t below = 0;  // number of radii whose square is less than the squared distance
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const double farthest2 = distance2(points[i], points[lists[i].back()]);
    radius[i] = std::sqrt(farthest2);
    if (radius[i] * radius[i] >= farthest2) continue;
    ++below;
    --expected[i];
  }
  EXPECT_GT(below, 200u);
  EXPECT_EQ(chosen(*operators::limits_from_attributes({.radius = "r"}), points, lists, {radius}), expected);
}

TEST(LimitsFromAttributes, BothLimitsHoldTogether) {
  const Line line;
  EXPECT_EQ(line.kept({.k = "k", .radius = "r"}, {3, 5}), 3u);
  EXPECT_EQ(line.kept({.k = "k", .radius = "r"}, {5, 1}), 2u);
}

TEST(LimitsFromAttributes, WhatIsKeptIsTheNeighborhoodOfThatSize) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Vec3> points(500);
  for (Vec3& p : points) p = {uniform(random), uniform(random), uniform(random)};
  const auto lists = brute_force_neighbors(points, 60);
  std::vector<double> k(points.size()), radius(points.size());
  for (double& v : k) v = 80 * uniform(random);
  for (double& v : radius) v = 0.4 * uniform(random);
  const auto kept =
      chosen(*operators::limits_from_attributes({.k = "k", .radius = "r"}), points, lists, {k, radius}, 64);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const auto most = std::min<std::size_t>(static_cast<std::size_t>(k[i]), 60);
    EXPECT_EQ(kept[i], brute_force_neighbors_of(points, i, most, radius[i]).size()) << i;
  }
}

TEST(LimitsFromAttributes, NeedsTheNameOfAnAttribute) {
  EXPECT_THROW(operators::limits_from_attributes({}), UsageError);
}

}  // namespace
}  // namespace pointsweep
