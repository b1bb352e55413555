// SPDX-License-Identifier: MIT
#include "pointsweep/arrays.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>

#include "tests/pipeline/refusal.h"
#include "tests/support/brute_force.h"

namespace pointsweep {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t kPoints = 400;
constexpr std::size_t kNeighbors = 12;

/// Returns points of a wavy surface.
std::vector<std::array<double, 3>> wavy_surface() {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> side(0, 4);
  std::vector<std::array<double, 3>> points;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double x = side(random), y = side(random);
    points.push_back({x, y, std::sin(x) * std::cos(y)});
  }
  return points;
}

std::vector<Vec3> vectors(const std::vector<std::array<double, 3>>& points) {
  std::vector<Vec3> made;
  for (const auto& [x, y, z] : points) made.push_back({x, y, z});
  return made;
}

/// Returns the normal by the definition in Equation 1 of the paper: the eigenvector of the smallest eigenvalue of the
/// weighted covariance.
Eigen::Vector3d normal_by_definition(const std::vector<Vec3>& points, std::size_t i) {
  const std::vector<std::uint32_t> list =
      brute_force_neighbors_of(points, std::uint32_t(i), kNeighbors, std::numeric_limits<double>::infinity());
  const double variance = std::numbers::pi * distance2(points[list.back()], points[i]) / double(list.size());
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  for (const std::uint32_t j : list) {
    const Eigen::Vector3d d(points[j].x - points[i].x, points[j].y - points[i].y, points[j].z - points[i].z);
    m += std::exp(-d.squaredNorm() / (2 * variance)) * d * d.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(m).eigenvectors().col(0);
}

template <class T>
bool have_equal_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST(ArraysOfRuns, NormalsAreThoseOfEquation1OverAllPairs) {
  const auto points = wavy_surface();
  const std::vector<Vec3> known = vectors(points);
  const auto found = normals(points, {}, {.k = kNeighbors});
  ASSERT_EQ(found.size(), kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) {
    const Eigen::Vector3d n(found[i][0], found[i][1], found[i][2]);
    EXPECT_NEAR(n.norm(), 1, 1e-6) << i;
    EXPECT_LT(n.cross(normal_by_definition(known, i)).norm(), 1e-5) << i;
  }
}

TEST(ArraysOfRuns, NormalsTakeTheirOptionsAndTheNeighboursThatTheOperatorWants) {
  const auto points = wavy_surface();
  EXPECT_TRUE(have_equal_bytes(normals(points), normals(points, {}, {.k = 16})));
  EXPECT_FALSE(have_equal_bytes(normals(points), normals(points, {}, {.k = 17})));
  for (const auto& n : normals(points, {.orient = Orient::up})) EXPECT_GE(n[2], 0);
}

TEST(ArraysOfRuns, EveryKindOfArrayIsTheSamePoints) {
  std::vector<std::array<float, 3>> triples;
  std::vector<float> flat;
  std::vector<double> wide;
  for (const auto& point : wavy_surface()) {
    triples.push_back({float(point[0]), float(point[1]), float(point[2])});
    flat.insert(flat.end(), triples.back().begin(), triples.back().end());
    wide.insert(wide.end(), triples.back().begin(), triples.back().end());
  }
  const auto expected = normals(triples);
  EXPECT_TRUE(have_equal_bytes(normals(flat), expected));
  EXPECT_TRUE(have_equal_bytes(normals(std::span<const float>(flat)), expected));
  EXPECT_TRUE(have_equal_bytes(normals(wide), expected));
}

TEST(ArraysOfRuns, ResultsAreTakenByFieldAndByAttribute) {
  const auto points = wavy_surface();
  const ArrayResults results = run(points, {.stages = {operators::normals(), operators::curvature()}});
  EXPECT_EQ(results.size(), kPoints);
  EXPECT_EQ(results.statistics().points, kPoints);
  const auto unit = results.get<std::array<float, 3>>("normal");
  EXPECT_TRUE(have_equal_bytes(unit, normals(points, {}, {.k = 32}))) << "curvature wants 32";
  const auto ny = results.get<float>("ny");
  const auto x = results.get<double>("x");
  const auto k1 = results.get<float>("k1"), k2 = results.get<float>("k2"), mean = results.get<float>("mean_curvature");
  for (std::size_t i = 0; i < kPoints; ++i) {
    EXPECT_EQ(ny[i], unit[i][1]);
    EXPECT_EQ(x[i], points[i][0]);
    EXPECT_NEAR(mean[i], (k1[i] + k2[i]) / 2, 1e-5 * (1 + mean[i]));
  }
}

TEST(ArraysOfRuns, ASelectLeavesTheRowsOfItsCondition) {
  const auto points = wavy_surface();
  Chain chain;
  chain.stages = {operators::where("z > 0")};
  const ArrayResults results = run(points, chain);
  std::vector<double> z;
  for (const auto& point : points)
    if (point[2] > 0) z.push_back(point[2]);
  EXPECT_TRUE(have_equal_bytes(results.get<double>("z"), z));
}

TEST(ArraysOfRuns, NamesAndTypesThatTheResultsDoNotHaveAreRefused) {
  const auto points = wavy_surface();
  const ArrayResults results = run(points, {.stages = {operators::normals()}});
  EXPECT_THAT(refusal([&] { results.get<float>("k1"); }), HasSubstr("'k1' is not among the results"));
  EXPECT_THAT(refusal([&] { results.get<double>("nx"); }), HasSubstr("'nx' has 1 of float32 for each point"));
  EXPECT_THAT(refusal([&] { results.get<float>("normal"); }), HasSubstr("'normal' has 3 of float32"));
  EXPECT_THAT(refusal([&] { results.get<std::uint32_t>("nx"); }), HasSubstr("1 of uint32"));
}

TEST(ArraysOfRuns, PointsThatCannotBeReadAreRefused) {
  EXPECT_THAT(refusal([] { normals(std::vector<float>(4)); }), HasSubstr("holds 4 values"));
  EXPECT_THROW(normals(std::vector<float>()), Error);
  EXPECT_THROW(run(std::vector<std::array<double, 3>>(), {.stages = {operators::normals()}}), Error);
}

TEST(ArraysOfRuns, APointWithoutAPlaceHasNoNormal) {
  auto points = wavy_surface();
  points[7][1] = std::numeric_limits<double>::quiet_NaN();
  const auto found = normals(points);
  EXPECT_EQ(found.size(), kPoints);
  EXPECT_EQ(found[7], (std::array<float, 3>{}));
}

}  // namespace
}  // namespace pointsweep
