// SPDX-License-Identifier: MIT
#include "pointsweep/operators/surface/normals.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "pointsweep/error.h"
#include "tests/operators/equation1.h"
#include "tests/support/brute_force.h"
#include "tests/support/in_core.h"

namespace pointsweep {
namespace {

using Normal = std::array<float, 3>;
using Lists = std::vector<std::vector<std::uint32_t>>;

Vec3 wide(Normal n) { return {n[0], n[1], n[2]}; }
/// Returns the angle between the lines of two vectors, in radians.
double angle(Vec3 a, Vec3 b) { return std::atan2(length(cross(a, b)), std::abs(dot(a, b))); }

std::vector<Vec3> random_cloud(std::size_t n, Vec3 extent, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i)
    points.push_back({extent.x * u(random), extent.y * u(random), extent.z * u(random)});
  return points;
}

std::vector<Normal> normals_of(const std::vector<Vec3>& points, const Lists& lists, const NormalsOptions& options = {},
                               std::uint64_t* degenerate = nullptr) {
  const InCoreResult result = InCoreCloud(points, lists).apply(Normals(options));
  if (degenerate) *degenerate = result.degenerate;
  return result.column<Normal>(0);
}

void expect_equation1(const std::vector<Vec3>& points, const Lists& lists) {
  const std::vector<Normal> found = normals_of(points, lists);
  std::size_t compared = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Equation1 truth(points, i, lists[i]);
    if (truth.gap < 1e-8) continue;
    ++compared;
    EXPECT_LE(angle(wide(found[i]), truth.normal), 2e-7 + 1e-7 / truth.own_gap) << i;
    EXPECT_NEAR(length(wide(found[i])), 1, 1e-7);
  }
  EXPECT_GE(compared, points.size() * 9 / 10);
}

TEST(Normals, EqualEquation1WhereTheEigenvaluesDiffer) {
  for (const std::size_t k : {2u, 3u, 8u, 24u, 400u}) {
    SCOPED_TRACE(k);
    for (const Vec3 extent : {Vec3{1, 1, 1}, Vec3{1, 1, 1e-4}, Vec3{1, 1e-3, 1e-6}}) {
      const std::vector<Vec3> points = random_cloud(500, extent, unsigned(k));
      expect_equation1(points, brute_force_neighbors(points, k));
    }
  }
}

TEST(Normals, EqualEquation1WithNeighborhoodsOfAllSizesSideBySide) {
  const std::vector<Vec3> points = random_cloud(600, {1, 1, 0.1}, 7);
  Lists lists;
  for (std::uint32_t i = 0; i < points.size(); ++i) lists.push_back(brute_force_neighbors_of(points, i, 2 + i % 37, 9));
  expect_equation1(points, lists);
}

TEST(Normals, EqualEquation1WithinARadius) {
  const std::vector<Vec3> points = random_cloud(800, {1, 0.2, 0.1}, 8);
  expect_equation1(points, brute_force_neighbors(points, 1000, 0.3));
}

TEST(Normals, EqualEquation1AtMapCoordinatesWithMillimetres) {
  std::vector<Vec3> points = random_cloud(500, {0.01, 0.01, 0.001}, 9);
  for (Vec3& p : points) p = Vec3{4'512'345.678, 5'398'765.432, 812.1} + p;
  expect_equation1(points, brute_force_neighbors(points, 8));
}

TEST(Normals, EqualEquation1AtAnyScale) {
  for (const double s : {1e-150, 1e-100, 1e-12, 1e-6, 1e6, 1e12, 1e100, 1e150}) {
    SCOPED_TRACE(s);
    const std::vector<Vec3> points = random_cloud(300, {s, s, 0.1 * s}, 10);
    expect_equation1(points, brute_force_neighbors(points, 8));
  }
}

/// Points and their true normals, with the largest curvature of the surface.
struct Surface {
  std::function<std::pair<Vec3, Vec3>(double, double)> at;  // point and normal for two uniform numbers in [0, 1)
  double curvature;
};

/// Expects normals near the true normals. Neighbours within r lie within κ r²/2 of the tangent plane. Random neighbours
/// do not surround a point evenly, so a normal may be off by about half of κ r, rarely more, and on average by a
/// fraction of κ r.
void expect_tangent_plane(const Surface& surface) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> u(0, 1);
  std::vector<Vec3> points, truth;
  for (int i = 0; i < 40000; ++i) {
    const double a = u(random), b = u(random);
    const auto [p, n] = surface.at(a, b);
    points.push_back(p), truth.push_back(n);
  }
  for (const std::size_t k : {8u, 16u, 64u}) {
    Lists lists(points.size());
    const std::size_t asked = 200;
    for (std::uint32_t i = 0; i < asked; ++i) lists[i] = brute_force_neighbors_of(points, i, k, 100);
    std::uint64_t degenerate = 0;
    const std::vector<Normal> found = normals_of(points, lists, {}, &degenerate);
    EXPECT_EQ(degenerate, points.size() - asked);
    double sum = 0, sum_reach = 0;
    for (std::uint32_t i = 0; i < asked; ++i) {
      const double reach = std::sqrt(distance2(points[i], points[lists[i].back()]));
      EXPECT_LE(angle(wide(found[i]), truth[i]), surface.curvature * reach) << "k " << k << " point " << i;
      sum += angle(wide(found[i]), truth[i]), sum_reach += reach;
    }
    EXPECT_LE(sum, 0.35 * surface.curvature * sum_reach) << "k " << k;
  }
}

constexpr double kTurn = 2 * std::numbers::pi;

TEST(Normals, OfASpherePointAlongTheRadius) {
  expect_tangent_plane({[](double a, double b) {
                          const double z = 2 * b - 1, r = std::sqrt(1 - z * z);
                          const Vec3 p{r * std::cos(kTurn * a), r * std::sin(kTurn * a), z};
                          return std::pair(p, p);
                        },
                        1.0});
}

TEST(Normals, OfACylinderPointAwayFromTheAxis) {
  expect_tangent_plane({[](double a, double b) {
                          const Vec3 n{std::cos(kTurn * a), std::sin(kTurn * a), 0};
                          return std::pair(n + Vec3{0, 0, 2 * b}, n);
                        },
                        1.0});
}

TEST(Normals, OfATorusPointAwayFromItsCircle) {
  expect_tangent_plane({[](double a, double b) {
                          const Vec3 out{std::cos(kTurn * a), std::sin(kTurn * a), 0};
                          const Vec3 n = std::cos(kTurn * b) * out + Vec3{0, 0, std::sin(kTurn * b)};
                          return std::pair(out + 0.5 * n, n);
                        },
                        2.0});
}

TEST(Normals, OfAnAxisAlignedPlaneAreTheAxis) {
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 extent{1, 1, 1};
    extent[axis] = 0;
    std::vector<Vec3> points = random_cloud(300, extent, 12);
    for (Vec3& p : points) p[axis] = 812.625;
    for (const Normal n : normals_of(points, brute_force_neighbors(points, 8))) {
      EXPECT_NEAR(n[std::size_t(axis)], 1, 1e-6);
      EXPECT_NEAR(length(cross(wide(n), Vec3{axis == 0 ? 1. : 0., axis == 1 ? 1. : 0., axis == 2 ? 1. : 0.})), 0, 1e-6);
    }
  }
}

TEST(Normals, KeepTheirBitsUnderAnExactTranslation) {
  std::vector<Vec3> points = random_cloud(500, {1, 1, 0.1}, 13);
  for (Vec3& p : points)
    p = {std::round(p.x * 0x1p20) / 0x1p20, std::round(p.y * 0x1p20) / 0x1p20, std::round(p.z * 0x1p20) / 0x1p20};
  std::vector<Vec3> moved;
  for (const Vec3 p : points) moved.push_back(p + Vec3{0x1p22, -0x1p21, 0x1p19});
  EXPECT_EQ(normals_of(points, brute_force_neighbors(points, 8)), normals_of(moved, brute_force_neighbors(moved, 8)));
}

TEST(Normals, KeepTheirBitsUnderAScalingByAPowerOfTwo) {
  const std::vector<Vec3> points = random_cloud(500, {1, 1, 0.1}, 14);
  for (const double s : {0x1p-40, 0x1p-3, 0x1p41}) {
    std::vector<Vec3> scaled;
    for (const Vec3 p : points) scaled.push_back(s * p);
    EXPECT_EQ(normals_of(points, brute_force_neighbors(points, 9)),
              normals_of(scaled, brute_force_neighbors(scaled, 9)));
  }
}

TEST(Normals, FollowARotation) {
  const std::vector<Vec3> points = random_cloud(500, {1, 1, 0.1}, 15);
  const Eigen::Matrix3d q = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2).normalized().toRotationMatrix();
  const auto turn = [&](Vec3 v) {
    const Eigen::Vector3d t = q * Eigen::Vector3d(v.x, v.y, v.z);
    return Vec3{t.x(), t.y(), t.z()};
  };
  std::vector<Vec3> turned;
  for (const Vec3 p : points) turned.push_back(turn(p));
  const Lists lists = brute_force_neighbors(points, 8);
  const std::vector<Normal> before = normals_of(points, lists), after = normals_of(turned, lists);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (Equation1(points, i, lists[i]).gap > 1e-4) {
      EXPECT_LE(angle(turn(wide(before[i])), wide(after[i])), 1e-6);
    }
}

TEST(Normals, SeeDuplicatesAsNothingButACount) {
  std::vector<Vec3> points{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  const Lists lists = brute_force_neighbors(points, 5);
  for (const Normal n : normals_of(points, lists)) EXPECT_EQ(n, (Normal{0, 0, 1}));
}

TEST(Normals, ExistWhereEveryNeighborIsFarAndEquallySo) {
  std::vector<Vec3> points{{0, 0, 0}};
  for (int i = 0; i < 6000; ++i) points.push_back({std::cos(i * 0.001), std::sin(i * 0.001), 0});
  Lists lists(points.size());
  lists[0] = brute_force_neighbors_of(points, 0, 6000, 2);  // θ = exp(-6000/2π) underflows for each of them
  EXPECT_EQ(normals_of(points, lists)[0], (Normal{0, 0, 1}));
}

TEST(Normals, AreZeroAndCountedWherePointsDefineNoPlane) {
  const auto count_zero = [](const std::vector<Vec3>& points, std::size_t k) {
    std::uint64_t degenerate = 0;
    for (const Normal n : normals_of(points, brute_force_neighbors(points, k), {}, &degenerate)) EXPECT_EQ(n, Normal{});
    return degenerate;
  };
  EXPECT_EQ(count_zero({}, 8), 0u);
  EXPECT_EQ(count_zero({{1, 2, 3}}, 8), 1u);
  EXPECT_EQ(count_zero({{1, 2, 3}, {2, 2, 3}}, 8), 2u);
  EXPECT_EQ(count_zero(random_cloud(50, {1, 1, 1}, 16), 1), 50u);
  EXPECT_EQ(count_zero(std::vector<Vec3>(100, Vec3{5, 6, 7}), 8), 100u);
  EXPECT_EQ(count_zero({{0, 0, 0}, {1e-320, 0, 0}, {0, 1e-320, 0}}, 2), 3u);
  EXPECT_EQ(count_zero({{-1e308, 0, 0}, {1e308, 0, 0}, {0, 1e308, 0}, {0, -1e308, 1e308}}, 3), 4u);
  constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(count_zero({{kNotANumber, 0, 0}, {1, 0, 0}, {2, 0, 0}}, 8), 3u);
}

TEST(Normals, OfPointsOnALineAreZeroWhereverTheLineLies) {
  for (const Vec3 origin : {Vec3{}, Vec3{3, 4, 5}, Vec3{4'512'345.678, 5'398'765.432, 812.1}})
    for (const Vec3 step : {Vec3{0.001, 0, 0}, Vec3{0.0011, 0.0023, -0.0017}, Vec3{1, 2, 3}}) {
      std::vector<Vec3> points;
      for (int i = 0; i < 200; ++i) points.push_back(origin + (i * 1.37) * step);
      std::uint64_t degenerate = 0;
      normals_of(points, brute_force_neighbors(points, 8), {}, &degenerate);
      EXPECT_EQ(degenerate, points.size()) << origin.x << " " << step.x;
    }
}

TEST(Normals, SeeAPlaneAsNarrowAsAHundredThousandthOfItsLength) {
  std::vector<Vec3> points;
  for (int i = 0; i < 100; ++i) points.push_back({0.01 * i, (i % 2 ? 1e-6 : 0) + (i % 3 ? 1e-7 : 0), 0});
  std::uint64_t degenerate = 0;
  for (const Normal n : normals_of(points, brute_force_neighbors(points, 8), {}, &degenerate))
    EXPECT_EQ(n, (Normal{0, 0, 1}));
  EXPECT_EQ(degenerate, 0u);
}

struct Oriented {
  std::vector<Vec3> points = random_cloud(1000, {1, 1, 1}, 17);
  Lists lists = brute_force_neighbors(points, 8);
};

TEST(Normals, HaveTheirLargestComponentPositiveByDefault) {
  const Oriented cloud;
  for (const Normal n : normals_of(cloud.points, cloud.lists)) {
    std::size_t largest = 0;
    for (std::size_t c = 1; c < 3; ++c)
      if (std::abs(n[c]) > std::abs(n[largest])) largest = c;
    EXPECT_GT(n[largest], 0);
  }
}

TEST(Normals, PointUpWhenToldSo) {
  const Oriented cloud;
  const std::vector<Normal> plain = normals_of(cloud.points, cloud.lists);
  const std::vector<Normal> up = normals_of(cloud.points, cloud.lists, {.orient = Orient::up, .viewpoint = {}});
  for (const Normal n : up) EXPECT_GE(n[2], 0);
  EXPECT_NE(plain, up);
  const std::vector<Vec3> wall{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}};
  for (const Normal n : normals_of(wall, brute_force_neighbors(wall, 3), {.orient = Orient::up, .viewpoint = {}}))
    EXPECT_EQ(n, (Normal{1, 0, 0}));
}

TEST(Normals, FaceTheViewpoint) {
  const Oriented cloud;
  for (const Vec3 eye : {Vec3{10, 3, 2}, Vec3{-10, -3, -2}, Vec3{0.1, 0.2, -0.1}}) {
    const std::vector<Normal> found =
        normals_of(cloud.points, cloud.lists, {.orient = Orient::viewpoint, .viewpoint = eye});
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_GE(dot(wide(found[i]), eye - cloud.points[i]), 0);
  }
  EXPECT_THROW(Normals({.orient = Orient::viewpoint, .viewpoint = Vec3{0, INFINITY, 0}}), UsageError);
}

TEST(Normals, AgreeWithTheNormalsOfTheInput) {
  const Oriented cloud;
  const std::vector<Vec3> random = random_cloud(cloud.points.size(), {1, 1, 1}, 18);
  std::vector<Normal> given;
  for (const Vec3 v : random) given.push_back({float(v.x), float(v.y), float(v.z)});
  given[3] = {};
  given[4] = {NAN, 0, 0};
  std::vector<std::vector<std::byte>> reads(1);
  reads[0].resize(given.size() * sizeof(Normal));
  std::memcpy(reads[0].data(), given.data(), reads[0].size());
  const Normals normals({.orient = Orient::input, .viewpoint = {}});
  ASSERT_EQ(normals.contract().reads.size(), 1u);
  const std::vector<Normal> found = InCoreCloud(cloud.points, cloud.lists).apply(normals, reads).column<Normal>(0);
  const std::vector<Normal> plain = normals_of(cloud.points, cloud.lists);
  EXPECT_NE(found, plain);
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (i == 3 || i == 4) {
      EXPECT_EQ(found[i], plain[i]);
    } else {
      EXPECT_GE(dot(wide(found[i]), wide(given[i])), 0);
    }
  }
}

}  // namespace
}  // namespace pointsweep
