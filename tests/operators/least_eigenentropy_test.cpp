// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

#include "pointsweep/error.h"
#include "pointsweep/operators.h"
#include "tests/operators/chosen.h"
#include "tests/support/brute_force.h"
#include "tests/support/instruction_sets.h"

namespace pointsweep {
namespace {

using Lists = std::vector<std::vector<std::uint32_t>>;

/// Returns the eigenentropy of a point and its first k neighbours: mean, covariance and logarithms in long double.
long double eigenentropy(const std::vector<Vec3>& points, std::size_t i, const std::vector<std::uint32_t>& list,
                         std::size_t k) {
  using Real = long double;
  using Vector = Eigen::Matrix<Real, 3, 1>;
  using Matrix = Eigen::Matrix<Real, 3, 3>;
  std::vector<Vector> all{{points[i].x, points[i].y, points[i].z}};
  for (std::size_t j = 0; j < k; ++j) all.push_back({points[list[j]].x, points[list[j]].y, points[list[j]].z});
  Vector mean = Vector::Zero();
  for (const Vector& p : all) mean += p / Real(all.size());
  Matrix covariance = Matrix::Zero();
  for (const Vector& p : all) covariance += (p - mean) * (p - mean).transpose() / Real(all.size());
  const Vector value = Eigen::SelfAdjointEigenSolver<Matrix>(covariance).eigenvalues();
  Real entropy = 0;
  for (int a = 0; a < 3; ++a) {
    const Real e = value(a) / value.sum();
    if (e > 1e-15L) entropy -= e * std::log(e);
  }
  return entropy;
}

/// Returns a plane, an edge and a thicket with some noise, whose neighbourhoods have different best sizes.
std::vector<Vec3> scene(std::size_t n, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> u(0, 1);
  std::normal_distribution<double> noise(0, 0.003);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = u(random), y = u(random), z = u(random);
    if (i % 4 == 0) points.push_back({x, noise(random), y});
    if (i % 4 == 1) points.push_back({x, y, noise(random)});
    if (i % 4 == 2) points.push_back({2 + 0.2 * x, 0.2 * y, 0.2 * z});
    if (i % 4 == 3) points.push_back({1.5 + noise(random), noise(random), z});
  }
  return points;
}

TEST(LeastEigenentropy, ChoosesTheSizeThatAPlainEvaluationChooses) {
  const std::vector<Vec3> points = scene(800, 1);
  const Lists lists = brute_force_neighbors(points, 60);
  const std::vector<std::uint32_t> found = chosen(*operators::least_eigenentropy(10), points, lists);
  std::vector<std::size_t> seen(61, 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::size_t best = 10;
    long double least = eigenentropy(points, i, lists[i], best), second = std::numeric_limits<double>::infinity();
    for (std::size_t k = 11; k <= 60; ++k) {
      const long double e = eigenentropy(points, i, lists[i], k);
      if (e < least)
        second = least, least = e, best = k;
      else
        second = std::min(second, e);
    }
    ++seen[best];
    if (second - least < 1e-12L) continue;  // rounding may decide between two sizes
    ASSERT_EQ(found[i], best) << i;
  }
  EXPECT_GE(std::count_if(seen.begin(), seen.end(), [](std::size_t n) { return n > 0; }), 30) << "sizes differ";
}

TEST(LeastEigenentropy, TakesTheSmallestOfEqualSizes) {
  std::vector<Vec3> line;
  for (int x = 0; x < 30; ++x) line.push_back({double(x), 0, 0});
  for (const std::uint32_t k : chosen(*operators::least_eigenentropy(5), line, brute_force_neighbors(line, 20)))
    EXPECT_EQ(k, 5u);
}

TEST(LeastEigenentropy, FewNeighborsAreAllKept) {
  const std::vector<Vec3> points = scene(40, 2);
  for (const std::size_t k : {0u, 1u, 9u, 10u})
    for (const std::uint32_t kept :
         chosen(*operators::least_eigenentropy(10), points, brute_force_neighbors(points, k)))
      EXPECT_EQ(kept, k);
}

TEST(LeastEigenentropy, PointsInOnePlaceKeepAllAndDuplicatesAreNoObstacle) {
  const std::vector<Vec3> one_place(40, Vec3{5e6, 4e6, 100});
  for (const std::uint32_t kept :
       chosen(*operators::least_eigenentropy(4), one_place, brute_force_neighbors(one_place, 20)))
    EXPECT_EQ(kept, 20u);
  std::vector<Vec3> points = scene(60, 3);
  points.insert(points.end(), 12, points.front());
  const auto kept = chosen(*operators::least_eigenentropy(4), points, brute_force_neighbors(points, 30));
  EXPECT_GT(kept.front(), 12u) << "twelve are in the same place and show no shape";
}

TEST(LeastEigenentropy, DoesNotDependOnScalePlaceBatchOrInstructionSet) {
  const std::vector<Vec3> points = scene(300, 4);
  const Lists lists = brute_force_neighbors(points, 40);
  const SharedRule shared = operators::least_eigenentropy(10);
  const NeighborhoodRule& rule = *shared;
  const auto found = chosen(rule, points, lists);
  for (const double scale : {0x1p-500, 0x1p-30, 0x1p40, 0x1p500}) {
    std::vector<Vec3> scaled;
    for (const Vec3 p : points) scaled.push_back(scale * p);
    EXPECT_EQ(chosen(rule, scaled, lists), found) << scale;
  }
  for (const std::size_t cell : {1u, 7u, 128u}) EXPECT_EQ(chosen(rule, points, lists, {}, cell), found) << cell;
  for_each_instruction_set([&] { EXPECT_EQ(chosen(rule, points, lists), found); });
}

TEST(LeastEigenentropy, RefusesALeastKThatSpansNoVolume) { EXPECT_THROW(operators::least_eigenentropy(2), UsageError); }

}  // namespace
}  // namespace pointsweep
