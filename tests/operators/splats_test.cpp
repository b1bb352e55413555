// SPDX-License-Identifier: MIT
#include "pointsweep/operators/surface/splats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "pointsweep/operators/surface/curvature.h"
#include "pointsweep/operators/surface/normals.h"
#include "tests/operators/analytic_surface.h"
#include "tests/support/brute_force.h"
#include "tests/support/in_core.h"

namespace pointsweep {
namespace {

using Float3 = std::array<float, 3>;
using Lists = std::vector<std::vector<std::uint32_t>>;
using Points = std::vector<AnalyticPoint>;

enum MadeBySplats { kAxis, kLength, kRatio };

struct SplatCloud {
  std::vector<Vec3> points;
  Lists lists;
  Column normals;
  InCoreResult splats;

  SplatCloud(std::vector<Vec3> positions, std::size_t k) : points(std::move(positions)) {
    lists = brute_force_neighbors(points, k);
    normals = InCoreCloud(points, lists).apply(Normals()).columns[0];
  }
  std::vector<Column> inputs(SplatAxes axes) const {
    std::vector<Column> reads{normals};
    if (axes == SplatAxes::curvature) {
      const InCoreResult c = InCoreCloud(points, lists).apply(Curvature(), reads, reads);
      reads.insert(reads.end(), {c.columns[2], c.columns[0], c.columns[1]});
    }
    return reads;
  }
  const InCoreResult& make(SplatAxes axes = SplatAxes::positions, std::size_t cell_points = kCellCapacity) {
    return splats = InCoreCloud(points, lists, cell_points).apply(Splats({axes}), inputs(axes));
  }
};

Points sphere(std::size_t n, unsigned seed) {
  return AnalyticSurface::draw(n, [s = AnalyticSurface(seed)]() mutable { return s.sphere(2); });
}
Points torus(std::size_t n, unsigned seed) {
  return AnalyticSurface::draw(n, [s = AnalyticSurface(seed)]() mutable { return s.torus(0.4); });
}
Points cylinder(std::size_t n, unsigned seed) {
  return AnalyticSurface::draw(n, [s = AnalyticSurface(seed)]() mutable { return s.cylinder(0.5, 3); });
}

/// The splats of a cloud as plain values, for many queries.
struct Cover {
  std::vector<Vec3> points, major, minor;  // axes divided by their lengths
  double area = 0;                         // of all splats

  explicit Cover(const SplatCloud& cloud) : points(cloud.points) {
    const auto normals = InCoreResult{{cloud.normals}}.column<Float3>(0), axes = cloud.splats.column<Float3>(kAxis);
    const auto length = cloud.splats.column<float>(kLength), ratio = cloud.splats.column<float>(kRatio);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double a = length[i], b = a * ratio[i];
      major.push_back((1 / a) * wide(axes[i]));
      minor.push_back((1 / b) * cross(wide(normals[i]), wide(axes[i])));
      area += std::numbers::pi * a * b;
    }
  }
  /// Returns how many splats of points within `near` of x lie over x.
  std::size_t over(Vec3 x, double near) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 d = x - points[i];
      if (dot(d, d) > near * near) continue;
      const double u = dot(d, major[i]), v = dot(d, minor[i]);
      count += u * u + v * v <= 1;
    }
    return count;
  }
};

void expect_cover(const char* name, Points (*surface)(std::size_t, unsigned), SplatCloud& cloud, std::size_t k,
                  SplatAxes axes, double surface_area) {
  EXPECT_EQ(cloud.make(axes).degenerate, 0u);
  const Cover cover(cloud);
  const std::size_t asked = 5000;
  const double near = 8 * std::sqrt(surface_area / 3000);  // 8 spacings: excludes splats of another sheet
  std::size_t bare = 0;
  for (const AnalyticPoint& x : surface(asked, 2)) bare += cover.over(x.position, near) == 0;
  const std::string label = std::string(name) + "_k" + std::to_string(k) + (axes == SplatAxes::curvature ? "_c" : "_m");
  testing::Test::RecordProperty(label, std::to_string(bare) + " area " + std::to_string(cover.area / surface_area));
  EXPECT_LE(bare, asked / 1000) << label;
  EXPECT_LE(cover.area, 13 * surface_area) << label;
}

TEST(Splats, CoverASphereAndATorusWithoutHoles) {
  constexpr double kPi = std::numbers::pi;
  for (const std::size_t k : {8u, 16u, 32u}) {
    SplatCloud of_sphere(positions_of(sphere(3000, 1)), k), of_torus(positions_of(torus(3000, 1)), k);
    for (const SplatAxes axes : {SplatAxes::positions, SplatAxes::curvature}) {
      expect_cover("sphere", sphere, of_sphere, k, axes, 16 * kPi);
      expect_cover("torus", torus, of_torus, k, axes, 4 * kPi * kPi * 0.4);
    }
  }
}

TEST(Splats, HoldEightNeighborsEach) {
  SplatCloud cloud(positions_of(torus(1000, 3)), 20);
  cloud.make();
  const Cover cover(cloud);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    std::size_t held = 0, nearly = 0;
    for (const std::uint32_t j : cloud.lists[i]) {
      const Vec3 d = cloud.points[j] - cloud.points[i];
      const double u = dot(d, cover.major[i]), v = dot(d, cover.minor[i]), r2 = u * u + v * v;
      held += r2 <= 1 - 1e-5, nearly += r2 <= 1 + 1e-5;
    }
    EXPECT_EQ(held, 7u) << i;
    EXPECT_EQ(nearly, 8u) << i;
  }
}

TEST(Splats, AreCirclesTwiceTooWideOnASquareGrid) {
  std::vector<Vec3> grid;
  for (int x = 0; x < 20; ++x)
    for (int y = 0; y < 20; ++y) grid.push_back({double(x), double(y), 5});
  SplatCloud cloud(grid, 8);
  cloud.make();
  const std::size_t inner = 10 * 20 + 10;
  EXPECT_NEAR(cloud.splats.column<float>(kLength)[inner], std::sqrt(2), 1e-5);
  EXPECT_NEAR(cloud.splats.column<float>(kRatio)[inner], 1, 1e-6);
}

TEST(Splats, LieAlongANarrowRibbon) {
  std::vector<Vec3> ribbon;
  for (int x = 0; x < 60; ++x)
    for (int y = 0; y < 3; ++y) ribbon.push_back({double(x), double(y), 0});
  SplatCloud cloud(ribbon, 24);
  cloud.make();
  const std::size_t inner = 30 * 3 + 1;
  EXPECT_LE(line_angle(wide(cloud.splats.column<Float3>(kAxis)[inner]), {1, 0, 0}), 1e-6);
  EXPECT_LT(cloud.splats.column<float>(kRatio)[inner], 0.7);
}

TEST(Splats, OfCurvatureLieAlongACylinderAndAreThin) {
  SplatCloud cloud(positions_of(cylinder(2000, 4)), 16);
  cloud.normals = normals_of(cylinder(2000, 4));
  const InCoreResult round = cloud.make(), ridge = cloud.make(SplatAxes::curvature);
  EXPECT_NE(round.columns, ridge.columns);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    EXPECT_LE(line_angle(wide(ridge.column<Float3>(kAxis)[i]), {0, 0, 1}), 0.05);
    EXPECT_EQ(ridge.column<float>(kRatio)[i], 0.125f);
  }
}

TEST(Splats, OfCurvatureFallBackToPositionsWhereThereIsNone) {
  SplatCloud cloud(positions_of(torus(500, 5)), 8);
  std::vector<Column> reads = cloud.inputs(SplatAxes::curvature);
  const InCoreCloud core(cloud.points, cloud.lists);
  std::fill(reads[1].begin(), reads[1].end(), std::byte{0});
  EXPECT_EQ(core.apply(Splats({SplatAxes::curvature}), reads).columns, cloud.make().columns);
}

TEST(Splats, LieInTheTangentPlaneAndHaveRatiosUpToOne) {
  SplatCloud cloud(positions_of(torus(1000, 6)), 8);
  for (const SplatAxes axes : {SplatAxes::positions, SplatAxes::curvature}) {
    const InCoreResult made = cloud.make(axes);
    const auto normals = InCoreResult{{cloud.normals}}.column<Float3>(0);
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const Vec3 a = wide(made.column<Float3>(kAxis)[i]);
      EXPECT_NEAR(length(a), 1, 1e-6);
      EXPECT_NEAR(dot(a, wide(normals[i])), 0, 1e-6);
      EXPECT_GT(made.column<float>(kLength)[i], 0);
      EXPECT_GE(made.column<float>(kRatio)[i], 0.125f);
      EXPECT_LE(made.column<float>(kRatio)[i], 1.0f);
    }
  }
}

TEST(Splats, GrowWithTheCloudAndStayFinite) {
  const std::vector<Vec3> points = positions_of(torus(300, 7));
  SplatCloud cloud(points, 8);
  const InCoreResult before = cloud.make();
  for (const double s : {0x1p-40, 0x1p30}) {
    cloud.points.clear();
    for (const Vec3 p : points) cloud.points.push_back(s * p);
    const InCoreResult after = cloud.make();
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_EQ(after.column<float>(kLength)[i], float(s * before.column<float>(kLength)[i]));
    EXPECT_EQ(after.columns[kRatio], before.columns[kRatio]);
  }
  for (const double s : {1e-200, 1e200}) {
    cloud.points.clear();
    for (const Vec3 p : points) cloud.points.push_back(s * p);
    for (const float l : cloud.make().column<float>(kLength)) EXPECT_TRUE(std::isfinite(l));
  }
}

TEST(Splats, DoNotDependOnWhatSharesTheBatch) {
  SplatCloud cloud(positions_of(torus(600, 8)), 8);
  for (const SplatAxes axes : {SplatAxes::positions, SplatAxes::curvature}) {
    const InCoreResult whole = cloud.make(axes);
    for (const std::size_t cell : {1u, 7u, 500u}) EXPECT_EQ(cloud.make(axes, cell).columns, whole.columns);
  }
}

TEST(Splats, SeeDuplicatesAsNothing) {
  std::vector<Vec3> points;
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y) points.push_back({double(x), double(y), 0});
  points.insert(points.end(), 10, Vec3{1, 1, 0});
  SplatCloud cloud(points, 18);
  cloud.make();
  EXPECT_NEAR(cloud.splats.column<float>(kLength)[4], std::sqrt(2), 1e-5);
}

TEST(Splats, AreZeroAndCountedWithoutNormalOrNeighbor) {
  SplatCloud cloud(positions_of(sphere(50, 9)), 8);
  auto normals = InCoreResult{{cloud.normals}}.column<Float3>(0);
  normals[0] = {};
  normals[1] = {NAN, 0, 0};
  cloud.normals = column_of(normals);
  cloud.lists[2].clear();
  cloud.lists[3].assign(3, 3);
  const InCoreResult made = cloud.make();
  EXPECT_EQ(made.degenerate_rows, (std::vector<std::uint64_t>{0, 1, 2, 3}));
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(made.column<Float3>(kAxis)[i] == Float3{}, i < 4);
    EXPECT_EQ(made.column<float>(kLength)[i] == 0, i < 4);
    EXPECT_EQ(made.column<float>(kRatio)[i] == 0, i < 4);
  }
}

}  // namespace
}  // namespace pointsweep
