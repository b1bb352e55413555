// SPDX-License-Identifier: MIT
/// The operators distance_to and m3c2 against loops over all points of both clouds.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>

#include "pointsweep/error.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/formats/temporary_folder.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class Change : public testing::Test {
 protected:
  /// Writes points to a text file, which holds every double exactly, and returns its path.
  std::string written(const std::vector<Vec3>& points) {
    const std::filesystem::path path = folder_ / "other.xyz";
    std::ofstream file(path);
    for (const Vec3& p : points) file << fmt::format("{} {} {}\n", p.x, p.y, p.z);
    return path.string();
  }
  static RunResult run_pipeline(const std::vector<Vec3>& points, const std::string& pipeline,
                                const EngineOptions& options) {
    const Records input = with_attributes(points);
    InputCloud cloud = input.cloud();
    return run_in_memory(cloud, build_chain(parse_pipeline(pipeline), cloud), options);
  }

  const TemporaryFolder folder_;
};

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

bool nearly(double a, double b) { return same(a, b) || std::abs(a - b) <= 1e-9 * (1 + std::abs(b)); }

TEST_F(Change, DistanceIsThatToTheNearestOfAllPoints) {
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, sized(900), 3), other = make_cloud(shape, sized(700), 4);
    const std::string file = written(other);
    for (const double most : {std::numeric_limits<double>::infinity(), 0.05}) {
      std::vector<double> expected;
      for (const Vec3& p : points) {
        double least = std::numeric_limits<double>::infinity();
        for (const Vec3& q : other) {
          const double x = p.x - q.x, y = p.y - q.y, z = p.z - q.z;
          if (const double d2 = x * x + y * y + z * z; d2 <= most * most) least = std::min(least, d2);
        }
        expected.push_back(std::isfinite(least) ? std::sqrt(least) : kNaN);
      }
      const std::string limit = std::isfinite(most) ? fmt::format(", most={}", most) : "";
      for (const EngineOptions& options : ways_to_run()) {
        const RunResult got = run_pipeline(points, fmt::format("distance_to(\"{}\"{})", file, limit), options);
        ASSERT_TRUE(std::ranges::equal(got.field("cloud_distance"), expected, same)) << name << limit;
      }
    }
  }
}

/// The points of a cloud in a cylinder: their number, and the mean and deviation of their places along the axis.
struct InCylinder {
  double count = 0, mean = kNaN, spread = kNaN;
};

InCylinder in_cylinder(const std::vector<Vec3>& points, Vec3 p, Vec3 n, double diameter, double depth) {
  std::vector<double> along;
  for (const Vec3& q : points) {
    const double x = q.x - p.x, y = q.y - p.y, z = q.z - p.z, a = x * n.x + y * n.y + z * n.z;
    const double cx = y * n.z - z * n.y, cy = z * n.x - x * n.z, cz = x * n.y - y * n.x;
    if (std::abs(a) <= depth && std::sqrt(cx * cx + cy * cy + cz * cz) <= diameter / 2) along.push_back(a);
  }
  InCylinder found{.count = static_cast<double>(along.size())};
  if (along.empty()) return found;
  found.mean = 0;
  for (const double a : along) found.mean += a / found.count;
  if (along.size() == 1) return found;
  double squares = 0;
  for (const double a : along) squares += (a - found.mean) * (a - found.mean);
  found.spread = std::sqrt(squares / (found.count - 1));
  return found;
}

TEST_F(Change, M3c2IsItsFormulaOverAllPointsOfBothClouds) {
  std::size_t compared = 0;
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, sized(500), 3), other = make_cloud(shape, sized(600), 4);
    // No offset between points of a grid equals this diameter or depth, so that rounding decides nothing.
    const std::string stage =
        fmt::format("m3c2(\"{}\", cylinder=0.8137, depth=0.4391, registration=0.01)", written(other));
    for (const EngineOptions& options : ways_to_run()) {
      const RunResult got = run_pipeline(points, "knn(k=10) | normals | " + stage, options);
      const auto nx = got.field("nx"), ny = got.field("ny"), nz = got.field("nz"),
                 distance = got.field("m3c2_distance"), lod = got.field("m3c2_lod"),
                 spread1 = got.field("m3c2_spread1"), spread2 = got.field("m3c2_spread2"),
                 samples1 = got.field("m3c2_samples1"), samples2 = got.field("m3c2_samples2");
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double length = std::sqrt(nx[i] * nx[i] + ny[i] * ny[i] + nz[i] * nz[i]);
        if (length == 0) {
          EXPECT_TRUE(std::isnan(distance[i]) && std::isnan(lod[i])) << name;
          EXPECT_TRUE(same(samples1[i], is_finite(points[i]) ? 0 : kNaN)) << name;
          continue;
        }
        const Vec3 n{nx[i] / length, ny[i] / length, nz[i] / length};
        const InCylinder a = in_cylinder(points, points[i], n, 0.8137, 0.4391);
        const InCylinder b = in_cylinder(other, points[i], n, 0.8137, 0.4391);
        const double level = 1.96 * (std::sqrt(a.spread * a.spread / a.count + b.spread * b.spread / b.count) + 0.01);
        ASSERT_EQ(samples1[i], a.count) << name;
        ASSERT_EQ(samples2[i], b.count) << name;
        ASSERT_TRUE(nearly(distance[i], b.mean - a.mean)) << name << ": " << distance[i] << ", " << b.mean - a.mean;
        ASSERT_TRUE(nearly(lod[i], level)) << name << ": " << lod[i] << ", " << level;
        ASSERT_TRUE(nearly(spread1[i], a.spread) && nearly(spread2[i], b.spread)) << name;
        compared += !std::isnan(lod[i]);
      }
    }
  }
  EXPECT_GT(compared, 1000u);
}

TEST_F(Change, HasTheSameBytesInAnyOrderOfRowsAndWithAnyPartOfItKept) {
  std::vector<Vec3> points = make_cloud(hostile_shapes().front().second, sized(900), 3);
  const std::string stage = fmt::format("m3c2(\"{}\", cylinder=0.5, depth=0.5)",
                                        written(make_cloud(hostile_shapes().front().second, sized(900), 4)));
  const RunResult whole = run_pipeline(points, "knn(k=8) | normals | " + stage, tiny(700));
  const auto all = whole.field("m3c2_lod");
  const Records input = with_attributes(points);
  InputCloud cloud = input.cloud();
  Chain chain = build_chain(parse_pipeline("knn(k=8) | normals | " + stage), cloud);
  chain.keep = {"m3c2_samples2", "m3c2_lod"};
  const RunResult part = run_in_memory(cloud, chain, tiny(100, true));
  EXPECT_TRUE(std::ranges::equal(part.field("m3c2_lod"), all, same));
  EXPECT_EQ(part.field("m3c2_samples2"), whole.field("m3c2_samples2"));
  EXPECT_FALSE(part.schema.find("m3c2_distance"));
  std::vector<std::size_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::shuffle(order, std::mt19937_64(5));
  std::vector<Vec3> shuffled;
  for (const std::size_t i : order) shuffled.push_back(points[i]);
  const auto again = run_pipeline(shuffled, "knn(k=8) | normals | " + stage, tiny(100)).field("m3c2_lod");
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_TRUE(same(again[i], all[order[i]]));
}

TEST_F(Change, MeasuresMovedPositionsAndRowsThatAreLeft) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes().front().second, sized(900), 3);
  const std::string stage =
      fmt::format("distance_to(\"{}\")", written(make_cloud(hostile_shapes().front().second, sized(900), 4)));
  const std::string fair = "knn(k=8) | normals | splats | fair";
  const std::vector<double> got = run_pipeline(points, fair + " | " + stage, tiny(100, true)).field("cloud_distance");
  const RunResult moved = run_pipeline(points, fair, tiny(700));
  std::vector<Vec3> there;
  for (std::size_t i = 0; i < points.size(); ++i)
    there.push_back({moved.field("x")[i], moved.field("y")[i], moved.field("z")[i]});
  EXPECT_TRUE(std::ranges::equal(got, run_pipeline(there, stage, tiny(700)).field("cloud_distance"), same));
  const auto all = run_pipeline(points, stage, tiny(700)).field("cloud_distance");
  std::vector<double> left;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (points[i].x < 0.1) left.push_back(all[i]);
  EXPECT_EQ(run_pipeline(points, "where(x < 0.1) | " + stage, tiny(100)).field("cloud_distance"), left);
  const auto far = run_pipeline(points, stage + " | where(cloud_distance > 0.02)", tiny(100, true));
  EXPECT_EQ(far.field("cloud_distance").size(),
            static_cast<std::size_t>(std::ranges::count_if(all, [](double d) { return d > 0.02; })));
}

TEST_F(Change, PointsWithoutAFinitePlaceHaveNoDistanceAndAreNotFound) {
  const std::string file = written({{0, 0, 0}, {kNaN, 1, 1}, {3, 0, 0}});
  const RunResult got = run_pipeline({{1, 0, 0}, {kNaN, 0, 0}, {5, 0, 0}}, "distance_to(\"" + file + "\")", tiny(700));
  EXPECT_TRUE(std::ranges::equal(got.field("cloud_distance"), std::vector<double>{1, kNaN, 2}, same));
}

TEST_F(Change, TellsWhatIsWrong) {
  const std::vector<Vec3> points(10);
  const auto refused = [&](const std::string& pipeline, const std::string& words) {
    try {
      run_pipeline(points, pipeline, tiny(700));
      ADD_FAILURE() << pipeline;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  refused("distance_to(/nowhere/at.las)", "/nowhere/at.las: no such file");
  refused("distance_to(a.las, most=0)", "most");
  refused("knn(k=4) | normals | m3c2(a.las, cylinder=0, depth=1)", "cylinder");
  refused("knn(k=4) | normals | m3c2(a.las, cylinder=1)", "depth");
  refused("m3c2(a.las, cylinder=1, depth=1)", "normal");
  refused("distance_to(\"" + written({}) + "\")", "other.xyz");
}

}  // namespace
}  // namespace pointsweep
