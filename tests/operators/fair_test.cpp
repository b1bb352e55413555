// SPDX-License-Identifier: MIT
#include "pointsweep/operators/surface/fair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/operators/surface/splats.h"
#include "tests/operators/analytic_surface.h"
#include "tests/support/brute_force.h"
#include "tests/support/in_core.h"

namespace pointsweep {
namespace {

using Float3 = std::array<float, 3>;
using Lists = std::vector<std::vector<std::uint32_t>>;

/// A cloud with the attributes that fairing reads.
struct FairCloud {
  std::vector<Vec3> points;
  Lists lists;
  std::vector<Float3> normals;
  std::vector<float> length, ratio;

  FairCloud(std::vector<Vec3> positions, std::size_t k) : points(std::move(positions)) {
    lists = brute_force_neighbors(points, k);
    const InCoreCloud core(points, lists);
    const InCoreResult n = core.apply(Normals()), s = core.apply(Splats(), n.columns);
    normals = n.column<Float3>(0);
    length = s.column<float>(1), ratio = s.column<float>(2);
  }
  InCoreResult run(const FairOptions& options, std::size_t cell_points = kCellCapacity) const {
    const std::vector<Column> reads{column_of(length), column_of(ratio)};
    const std::vector<Column> near{column_of(normals), column_of(length), column_of(ratio)};
    return InCoreCloud(points, lists, cell_points).apply(Fair(options), reads, near);
  }
  std::vector<Vec3> moved(const FairOptions& options) const {
    std::vector<Vec3> result;
    for (const auto& p : run(options).column<std::array<double, 3>>(0)) result.push_back({p[0], p[1], p[2]});
    return result;
  }
};

template <class Off>
double rms(const std::vector<Vec3>& points, Off off_surface) {
  double sum = 0;
  std::size_t count = 0;
  for (const Vec3 p : points) {
    const auto [off, counts] = off_surface(p);
    if (counts) sum += off * off, ++count;
  }
  EXPECT_GT(count, 100u);
  return std::sqrt(sum / double(count));
}

/// The setting of the tests of noise: noise of 0.05 % and widths f and g of 0.5 % of the diagonal of the bounding box,
/// k = 64, patches as dense as a unit sphere of 200,000 points.
constexpr double kDiagonal = 2 * std::numbers::sqrt3;  // diagonal of the bounding box of the unit sphere
constexpr double kNoise = 0.0005 * kDiagonal;
constexpr FairOptions kWidths{0.005 * kDiagonal, 0.005 * kDiagonal};

TEST(Fair, DividesTheNoiseOfASphereByThree) {
  AnalyticSurface s(1);
  std::vector<Vec3> cap;
  while (cap.size() < 3000) {  // 1.5 % of the sphere
    const double z = 1 - s.uniform(0, 0.03), a = s.uniform(0, kTurn), r = std::sqrt(1 - z * z);
    cap.push_back((1 + s.gaussian(kNoise)) * Vec3{r * std::cos(a), r * std::sin(a), z});
  }
  const auto off = [](Vec3 p) { return std::pair(length(p) - 1, p.z > 0.98); };
  const std::vector<Vec3> fair = FairCloud(cap, 64).moved(kWidths);
  RecordProperty("factor", std::to_string(rms(cap, off) / rms(fair, off)));
  EXPECT_LE(rms(fair, off), rms(cap, off) / 3);
}

TEST(Fair, DividesTheNoiseOfAPlaneByThree) {
  AnalyticSurface s(2);
  std::vector<Vec3> patch;
  const double half = 0.5 * std::sqrt(3000 * 4 * std::numbers::pi / 200'000);
  while (patch.size() < 3000) patch.push_back({s.uniform(-half, half), s.uniform(-half, half), s.gaussian(kNoise)});
  const auto off = [&](Vec3 p) { return std::pair(p.z, std::max(std::abs(p.x), std::abs(p.y)) < 0.8 * half); };
  const std::vector<Vec3> fair = FairCloud(patch, 64).moved(kWidths);
  RecordProperty("factor", std::to_string(rms(patch, off) / rms(fair, off)));
  EXPECT_LE(rms(fair, off), rms(patch, off) / 3);
}

/// Two faces of a cube, z = 0 with x <= 0 and x = 0 with z <= 0. Their common edge is the y axis.
struct Edge {
  double half = 0.5 * std::sqrt(3000 * 4 * std::numbers::pi / 200'000);
  std::vector<Vec3> points;
  std::vector<Float3> normals;

  explicit Edge(double noise) {
    AnalyticSurface s(3);
    for (int i = 0; i < 3000; ++i) {
      const double along = s.uniform(-half, half), in = s.uniform(-half, 0), out = s.gaussian(noise);
      points.push_back(i % 2 ? Vec3{in, along, out} : Vec3{out, along, in});
      normals.push_back(i % 2 ? Float3{0, 0, 1} : Float3{1, 0, 0});
    }
  }
  /// Returns a function of a point: its distance to the surface, and whether it counts. Points count within [from, to)
  /// of the edge.
  auto off(double from, double to) const {
    return [this, from, to](Vec3 p) {
      const double away = std::max(std::abs(p.x), std::abs(p.z));
      const bool inside = std::abs(p.y) < 0.8 * half && away < 0.8 * half;
      // Outside of the corner the nearest point of the surface is the edge itself.
      const double distance = p.x > 0 && p.z > 0 ? std::hypot(p.x, p.z) : std::min(std::abs(p.x), std::abs(p.z));
      return std::pair(distance, inside && away >= from && away < to);
    };
  }
};

TEST(Fair, LeavesTheEdgeOfACubeWhereItIsWhenNormalsAreTrue) {
  const Edge edge(0);
  FairCloud cloud(edge.points, 64);
  cloud.normals = edge.normals;
  const std::vector<Vec3> fair = cloud.moved(kWidths);
  EXPECT_EQ(rms(fair, edge.off(0, 1)), 0);
  EXPECT_NE(fair, edge.points);  // points slide along their face
}

TEST(Fair, KeepsTheEdgeOfANoisyCubeSharp) {
  const Edge edge(kNoise);
  const std::vector<Vec3> fair = FairCloud(edge.points, 64).moved(kWidths);
  const double spacing = std::sqrt(4 * std::numbers::pi / 200'000);
  const double near = rms(fair, edge.off(0, 2 * spacing)), inner = rms(fair, edge.off(4 * spacing, 1));
  RecordProperty("near_over_noise", std::to_string(near / kNoise));
  RecordProperty("inner_over_noise", std::to_string(inner / kNoise));
  EXPECT_LE(inner, kNoise / 3);
  EXPECT_LE(near, 0.8 * kNoise);
}

TEST(Fair, EqualsEquation3) {
  AnalyticSurface s(4);
  const std::vector<AnalyticPoint> torus = AnalyticSurface::draw(500, [&] { return s.torus(0.4); });
  const FairCloud cloud(positions_of(torus), 20);
  const FairOptions widths{0.2, 0.05};
  const std::vector<Vec3> fair = cloud.moved(widths);
  for (std::size_t i = 0; i < fair.size(); ++i) {
    std::vector<std::uint32_t> all = cloud.lists[i];
    all.push_back(std::uint32_t(i));
    long double weights = 0, sum[3] = {};
    for (const std::uint32_t j : all) {
      const Vec3 n = wide(cloud.normals[j]), to = cloud.points[j] - cloud.points[i];
      const Vec3 projected = cloud.points[i] + (dot(to, n) / dot(n, n)) * n, way = projected - cloud.points[i];
      const long double area = std::numbers::pi_v<long double> * cloud.length[j] * cloud.length[j] * cloud.ratio[j];
      const long double w = area * std::exp(-dot(to, to) / (2.0L * widths.f * widths.f)) *
                            std::exp(-dot(way, way) / (2.0L * widths.g * widths.g));
      for (int axis = 0; axis < 3; ++axis) sum[axis] += w * projected[axis];
      weights += w;
    }
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(fair[i][axis], double(sum[axis] / weights), 1e-13) << i;
  }
}

TEST(Fair, LooksAtBothWidths) {
  AnalyticSurface s(5);
  const FairCloud cloud(positions_of(AnalyticSurface::draw(300, [&] { return s.torus(0.4); })), 20);
  EXPECT_NE(cloud.moved({0.2, 0.05}), cloud.moved({0.1, 0.05}));
  EXPECT_NE(cloud.moved({0.2, 0.05}), cloud.moved({0.2, 0.02}));
}

TEST(Fair, MovesMapCoordinatesAsItMovesSmallOnes) {
  AnalyticSurface s(6);
  std::vector<Vec3> points;
  for (int i = 0; i < 400; ++i) {
    const auto on_grid = [](double v) { return std::round(v * 0x1p16) / 0x1p16; };
    points.push_back({on_grid(s.uniform(-1, 1)), on_grid(s.uniform(-1, 1)), on_grid(s.gaussian(0.02))});
  }
  const Vec3 away{0x1p22, -0x1p21, 0x1p19};
  std::vector<Vec3> moved;
  for (const Vec3 p : points) moved.push_back(p + away);
  const std::vector<Vec3> here = FairCloud(points, 20).moved({0.2, 0.2}),
                          there = FairCloud(moved, 20).moved({0.2, 0.2});
  for (std::size_t i = 0; i < here.size(); ++i) EXPECT_EQ(there[i], points[i] + away + (here[i] - points[i])) << i;
}

TEST(Fair, DoesNotSeeTheSignsOfNormals) {
  AnalyticSurface s(7);
  FairCloud cloud(positions_of(AnalyticSurface::draw(300, [&] { return s.torus(0.4); })), 20);
  const std::vector<Vec3> before = cloud.moved({0.2, 0.05});
  for (std::size_t i = 0; i < cloud.normals.size(); i += 1 + i % 3)
    for (float& c : cloud.normals[i]) c = -c;
  EXPECT_EQ(cloud.moved({0.2, 0.05}), before);
}

TEST(Fair, DoesNotDependOnWhatSharesTheBatch) {
  AnalyticSurface s(8);
  const FairCloud cloud(positions_of(AnalyticSurface::draw(500, [&] { return s.torus(0.4); })), 20);
  const InCoreResult whole = cloud.run({0.2, 0.05});
  for (const std::size_t cell : {1u, 7u, 400u}) EXPECT_EQ(cloud.run({0.2, 0.05}, cell).columns, whole.columns);
}

TEST(Fair, KeepsItsBitsUnderAScalingByAPowerOfTwo) {
  AnalyticSurface s(9);
  const std::vector<Vec3> points = positions_of(AnalyticSurface::draw(300, [&] { return s.torus(0.4); }));
  const std::vector<Vec3> before = FairCloud(points, 20).moved({0.2, 0.05});
  for (const double scale : {0x1p-30, 0x1p30}) {
    std::vector<Vec3> scaled, expected;
    for (const Vec3 p : points) scaled.push_back(scale * p);
    for (const Vec3 p : before) expected.push_back(scale * p);
    EXPECT_EQ(FairCloud(scaled, 20).moved({0.2 * scale, 0.05 * scale}), expected);
  }
}

TEST(Fair, LeavesAPointWithoutUsableNeighborsWhereItIsAndCountsIt) {
  AnalyticSurface s(10);
  FairCloud cloud(positions_of(AnalyticSurface::draw(100, [&] { return s.torus(0.4); })), 8);
  cloud.lists[0].clear();
  for (const std::uint32_t j : std::vector(cloud.lists[1])) cloud.normals[j] = {};
  cloud.normals[cloud.lists[1][0]] = {NAN, 0, 1};
  cloud.lists[2] = {3, 4, 5, 6};
  cloud.length[3] = 0, cloud.ratio[4] = 0, cloud.length[5] = NAN;
  cloud.length[6] = std::numeric_limits<float>::infinity();
  for (std::size_t i = 7; i < cloud.lists.size(); ++i) cloud.lists[i] = {50};
  cloud.normals[50] = {0, 0, 1}, cloud.length[50] = 1, cloud.ratio[50] = 1;
  const InCoreResult result = cloud.run({10, 10});
  const auto moved = result.column<std::array<double, 3>>(0);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ((Vec3{moved[i][0], moved[i][1], moved[i][2]}), cloud.points[i]) << i;
  EXPECT_GE(result.degenerate, 3u);
  EXPECT_LE(result.degenerate, 7u);
  ASSERT_EQ(result.degenerate_rows.size(), result.degenerate);
  for (std::uint64_t i = 0; i < 3; ++i) EXPECT_EQ(result.degenerate_rows[i], i);
  EXPECT_NE(moved[60][2], cloud.points[60].z);
}

TEST(Fair, RefusesWidthsThatAreNotPositiveLengths) {
  for (const double bad : {0.0, -1.0, double(NAN), double(INFINITY), 1e-320}) {
    EXPECT_THROW(Fair({bad, 1}), UsageError) << bad;
    EXPECT_THROW(Fair({1, bad}), UsageError) << bad;
  }
}

}  // namespace
}  // namespace pointsweep
