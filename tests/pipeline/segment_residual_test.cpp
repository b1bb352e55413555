// SPDX-License-Identifier: MIT
/// The attribute segment_residual against two passes over the points of each segment, in extended precision.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "pointsweep/verify/formulas/eigen.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/brute_components.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

struct Flatness {
  long double residual = 0, extent = 0;
};

/// Returns the flatness by number of the segment. The extent is the root mean square distance to the centroid.
std::map<double, Flatness> flatness(const std::vector<double>& segment, const std::vector<Vec3>& points) {
  using formulas::Vector;
  std::map<double, std::vector<Vector>> members;  // relative to the first point of the segment
  std::map<double, Vector> first;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (segment[i] >= 0) {
      std::vector<Vector>& places = members[segment[i]];
      const Vector p{points[i].x, points[i].y, points[i].z};
      if (places.empty()) first[segment[i]] = p;
      places.push_back(p - first[segment[i]]);
    }
  std::map<double, Flatness> all;
  for (const auto& [number, places] : members) {
    const long double share = 1 / static_cast<long double>(places.size());
    Vector mean;
    for (const Vector& p : places) mean = mean + share * p;
    formulas::Matrix covariance;
    for (const Vector& p : places) covariance.add_outer_product(share, p - mean);
    const long double least = std::max<long double>(0, formulas::eigen_of(covariance).value[0]);
    all[number] = {places.size() < 4 ? 0 : std::sqrt(least), std::sqrt(covariance.trace())};
  }
  return all;
}

std::vector<double> residuals_of(const Records& input, const std::string& pipeline, const EngineOptions& options) {
  return run_text(input, pipeline, options).field("segment_residual");
}

/// Expects right residuals; NaN for points without a segment.
void expect_residuals(const RunResult& got, const std::vector<Vec3>& points, const std::string& name) {
  const auto segment = got.field("segment"), residual = got.field("segment_residual");
  const std::map<double, Flatness> expected = flatness(segment, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (segment[i] < 0) {
      EXPECT_TRUE(std::isnan(residual[i])) << name << ", point " << i;
      continue;
    }
    const Flatness& f = expected.at(segment[i]);
    const auto allowed = static_cast<double>(f.residual * 0x1p-23L + f.extent * 1e-7L + 0x1p-39L);
    ASSERT_NEAR(residual[i], static_cast<double>(f.residual), allowed) << name << ", point " << i;
  }
}

const char* const kChain = "knn(k=7) | normals | segments(angle=30)";

TEST(SegmentResidual, IsThatOfTwoPasses) {
  for (const auto& [name, shape] : hostile_shapes()) {
    const Records input = with_attributes(make_cloud(shape, sized(900), 94));
    const RunResult first = run_text(input, kChain, tiny(50'000));
    expect_residuals(first, input.positions(), name);
    for (const EngineOptions& options : ways_to_run()) {
      const RunResult other = run_text(input, kChain, options);
      ASSERT_EQ(other.records, first.records) << name;
    }
  }
}

/// The residual of a tilted plane with noise is that of the noise, at any place and in any unit.
TEST(SegmentResidual, OfANoisyPlaneIsItsNoiseAnywhere) {
  for (const Vec3 origin : {Vec3{0, 0, 0}, {612'000, 5'410'000, 480}, {-3e9, 7, 2e9}}) {
    for (const double unit : {1.0, 1000.0, 1e-4}) {
      std::mt19937_64 random(11);
      std::vector<Vec3> points, normals;
      for (int i = 0; i < 4000; ++i) {
        const double u = uniform(random), v = uniform(random), noise = uniform(random) < 0.5 ? 0.01 : -0.01;
        points.push_back(origin + unit * Vec3{u, v, 0.3 * u - 0.2 * v + noise * std::sqrt(1 + 0.09 + 0.04)});
        normals.push_back({0, 0, 1});
      }
      const Records input = records_with_normals(points, normals);
      const RunResult got = run_text(input, "knn(k=40) | segments(angle=20)", tiny(600));
      expect_residuals(got, points, fmt::format("origin {}, unit {}", origin.x, unit));
      const double step = std::abs(origin.x) * 0x1p-52;  // step of the coordinates in float64
      EXPECT_EQ(got.field("segment_size").front(), 4000) << unit;
      if (step < 1e-4 * unit) {
        EXPECT_NEAR(got.field("segment_residual").front(), 0.01 * unit, 2e-4 * unit);
      }
    }
  }
}

/// All points are one segment, in a plane across an axis, on a line or in one place; or each point is alone.
TEST(SegmentResidual, OfExactPlanesAndSinglePointsIsNone) {
  std::mt19937_64 random(12);
  for (int axis = 0; axis < 3; ++axis) {
    for (int flat = 1; flat <= 3; ++flat) {
      std::vector<Vec3> points;
      for (int i = 0; i < 500; ++i) {
        Vec3 p{uniform(random), uniform(random), uniform(random)};
        for (int a = 0; a < flat; ++a) p[(axis + a) % 3] = 0.7;
        points.push_back(p);
      }
      const Records input = records_with_normals(points, std::vector<Vec3>(points.size(), {0, 0, 1}));
      const RunResult got = run_text(input, "knn(k=60) | segments(angle=20)", tiny(100));
      EXPECT_EQ(got.field("segment_size"), std::vector<double>(500, 500));
      EXPECT_EQ(got.field("segment_residual"), std::vector<double>(500, 0)) << axis << " " << flat;
    }
  }
  const std::vector<Vec3> cloud = make_cloud(hostile_shapes()[0].second, 5000, 13);
  const Records alone = records_with_normals(cloud, std::vector<Vec3>(cloud.size()));
  for (const EngineOptions& options : ways_to_run()) {
    const RunResult got = run_text(alone, "segments(angle=20)", options);
    expect_residuals(got, cloud, "alone");
    for (const double size : got.field("segment_size")) EXPECT_LE(size, 1);
  }
}

TEST(SegmentResidual, DoesNotDependOnTheOrderOfTheInput) {
  std::vector<Vec3> points = make_cloud(hostile_shapes()[1].second, sized(3000), 95);
  std::mt19937_64 random(3);
  const auto by_place = [](const std::vector<Vec3>& places, const std::vector<double>& values) {
    std::map<std::tuple<double, double, double>, double> all;
    for (std::size_t i = 0; i < places.size(); ++i)
      if (is_finite(places[i])) all[{places[i].x, places[i].y, places[i].z}] = values[i];
    return all;
  };
  const auto expected = by_place(points, residuals_of(with_attributes(points), kChain, tiny(300)));
  for (int turn = 0; turn < 3; ++turn) {
    std::ranges::shuffle(points, random);
    EXPECT_EQ(by_place(points, residuals_of(with_attributes(points), kChain, tiny(70 + 300 * turn))), expected);
  }
}

/// After a stage that moves points, the planes are those of the moved points.
TEST(SegmentResidual, IsThatOfThePointsWhereTheyAreNow) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[1].second, sized(1500), 96));
  for (const EngineOptions& options : ways_to_run()) {
    const RunResult got = run_text(input, "knn(k=9) | normals | splats | fair | segments(angle=30)", options);
    const auto x = got.field("x"), y = got.field("y"), z = got.field("z");
    std::vector<Vec3> moved;
    for (std::size_t i = 0; i < x.size(); ++i) moved.push_back({x[i], y[i], z[i]});
    expect_residuals(got, moved, "moved");
    EXPECT_NE(got.field("segment_residual"), residuals_of(input, "knn(k=9) | normals | segments(angle=30)", options));
  }
}

TEST(SegmentResidual, KeepsThePlanesOfAScene) {
  std::mt19937_64 random(14);
  std::vector<Vec3> points;
  for (int i = 0; i < 2000; ++i) {
    const double u = uniform(random), v = uniform(random), a = 2 * M_PI * uniform(random);
    if (i % 2 == 0)
      points.push_back({u, v, 0.001 * uniform(random)});
    else
      points.push_back({3 + 0.3 * std::cos(a), 0.3 * std::sin(a), v});
  }
  const RunResult planes = run_text(
      with_attributes(points),
      "knn(k=12) | normals | segments(angle=20) | where(segment_size > 500 && segment_residual < 0.02)", tiny(300));
  EXPECT_GT(planes.field("x").size(), 900u);
  for (const double x : planes.field("x")) EXPECT_LE(x, 1);
}

}  // namespace
}  // namespace pointsweep
