// SPDX-License-Identifier: MIT
/// The operators decimate and voxel against loops over the whole cloud, written from their definitions.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <tuple>

#include "pointsweep/operators.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/run/preview.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/kept_rows.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/pipeline/plain_hash.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/reference_engine.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

std::array<double, 3> array_of(Vec3 p) { return {p.x, p.y, p.z}; }

/// The expected numbers are from a program in another language.
TEST(Decimate, HashesAreThoseOfSplitMix64) {
  EXPECT_EQ(plain_hash({0, 0, 0}, 0), 0x238275bc38fcbe91u);
  EXPECT_EQ(plain_hash({1, 2, 3}, 0), 0x82f7bd2230df7f4au);
  EXPECT_EQ(plain_hash({1, 2, 3}, 7), 0x1cfa707fd3cabbd5u);
  EXPECT_EQ(plain_hash({-0.0, 5e-324, -1e300}, 0), 0x352f71b54d3ee2c9u);
  EXPECT_EQ(plain_hash({500000.125, 4e6, -12.5}, 0x766f78656c), 0x881ea029751583b0u);
}

std::vector<bool> in_share(const std::vector<Vec3>& points, long double share, std::uint64_t seed) {
  std::vector<bool> keep;
  for (const Vec3& p : points)
    keep.push_back(!is_finite(p) || static_cast<long double>(plain_hash(array_of(p), seed)) < std::ldexp(share, 64));
  return keep;
}

TEST(Decimate, KeepsTheRowsWhoseHashIsBelowTheShare) {
  std::size_t turn = 0;
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    std::vector<Vec3> points = make_cloud(shape, sized(900), 31);
    for (int i = 1; i < 9; ++i) points.push_back({0.0, -0.0, 1.0 * i}), points.push_back({-0.0, 0.0, 1.0 * i});
    const Records input = with_attributes(points);
    const double share = std::array{0.5, 0.1, 0.9}[turn % 3];
    const std::uint64_t seed = std::array{0, 5}[turn++ % 2];
    const Records kept = input.kept(in_share(input.positions(), share, seed));
    const std::string text = fmt::format("decimate({}, seed={})", share, seed);
    for (const EngineOptions& options : ways_to_run(Order::input))
      ASSERT_TRUE(run_text(input, text, options).records == kept.bytes);
    if (kept.size() > 1) expect_as_over(input, "knn(k=5) | " + text + " | normals", kept, "knn(k=5) | normals");
  }
}

TEST(Decimate, KeepsNothingOfTheShare0AndAllOfTheShare1) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[1].second, 300, 32));
  EXPECT_EQ(run_text(input, "decimate(0)", tiny(100)).records.size(), 0u);
  EXPECT_TRUE(run_text(input, "decimate(1)", tiny(100)).records == input.bytes);
  for (const char* wrong : {"decimate(-0.1)", "decimate(1.5)", "decimate", "decimate(0.5, seed=-1)"})
    EXPECT_NE(refusal([&] { run_text(input, wrong, tiny(100)); }), "") << wrong;
  EXPECT_NE(refusal([] { operators::decimate({std::nan("")}); }).find("share is a number, 0 to 1, not "),
            std::string::npos);
}

std::set<std::tuple<double, double, double>> places_of(const RunResult& result) {
  const std::vector<double> x = result.field("x"), y = result.field("y"), z = result.field("z");
  std::set<std::tuple<double, double, double>> places;
  for (std::size_t i = 0; i < x.size(); ++i) places.emplace(x[i], y[i], z[i]);
  return places;
}

/// Shares are right within five standard deviations. Another seed gives another part, and a smaller part lies in a
/// larger part.
TEST(Decimate, SharesAreRandomPartsNestedInOneAnother) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[1].second, 20'000, 33));
  const auto places = [&](const char* text) { return places_of(run_text(input, text, tiny(5000))); };
  const auto third = places("decimate(0.3)"), tenth = places("decimate(0.1)"), other = places("decimate(0.3, seed=1)");
  EXPECT_NEAR(static_cast<double>(third.size()), 6000, 5 * std::sqrt(20'000 * 0.3 * 0.7));
  EXPECT_TRUE(std::ranges::includes(third, tenth));
  const auto both = places("decimate(0.3) | decimate(0.3, seed=1)");
  EXPECT_NEAR(static_cast<double>(both.size()), 1800, 5 * std::sqrt(20'000 * 0.09 * 0.91));
  EXPECT_TRUE(std::ranges::includes(other, both));
}

/// Returns which points stay, by comparing each point with all others of its voxel.
std::vector<bool> one_of_each_voxel(const std::vector<Vec3>& points, double size, bool by_hash) {
  using Voxel = std::tuple<double, double, double>;
  std::map<Voxel, std::vector<std::size_t>> members;
  std::vector<bool> keep(points.size(), true);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i];
    if (is_finite(p)) members[{std::floor(p.x / size), std::floor(p.y / size), std::floor(p.z / size)}].push_back(i);
  }
  for (const auto& [voxel, rows] : members) {
    const auto [vx, vy, vz] = voxel;
    const double c[3] = {(vx + 0.5) * size, (vy + 0.5) * size, (vz + 0.5) * size};
    const auto precedes = [&](std::size_t a, std::size_t b) {
      const auto rank = [&](std::size_t i) {
        const auto [x, y, z] = array_of(points[i]);
        const double d2 = (x - c[0]) * (x - c[0]) + (y - c[1]) * (y - c[1]) + (z - c[2]) * (z - c[2]);
        return std::tuple(by_hash ? 0 : d2, by_hash ? plain_hash({x, y, z}, 0x766f78656c) : 0, x, y, z, i);
      };
      return rank(a) < rank(b);
    };
    for (const std::size_t i : rows)
      keep[i] = std::ranges::none_of(rows, [&](std::size_t j) { return precedes(j, i); });
  }
  return keep;
}

TEST(Voxel, KeepsTheOneOfEachThatThePlainLoopKeeps) {
  for (const auto& [name, shape] : hostile_shapes()) {
    for (const double size : {1e-9, 0.004, 0.13, 1.0, 777.0}) {
      SCOPED_TRACE(fmt::format("{}, size {}", name, size));
      const bool by_hash = std::fmod(size * 1000, 2) == 0;
      const Records input = with_attributes(make_cloud(shape, sized(700), 34));
      const Records kept = input.kept(one_of_each_voxel(input.positions(), size, by_hash));
      const std::string text = fmt::format("voxel({}, keep={})", size, by_hash ? "hash" : "center");
      for (const EngineOptions& options : ways_to_run(Order::input)) {
        const RunResult got = run_text(input, text, options);
        ASSERT_TRUE(got.records == kept.bytes);
        EXPECT_EQ(got.statistics.sweeps, 0u);
      }
    }
  }
}

TEST(Voxel, LeavesTheCloudOfTheKeptRowsForAllLaterStages) {
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    const Records input = with_attributes(make_cloud(shape, sized(700), 35));
    const Records kept = input.kept(one_of_each_voxel(input.positions(), 0.07, false));
    if (kept.size() < 2) continue;
    expect_as_over(input, "knn(k=5) | voxel(0.07) | normals | curvature", kept, "knn(k=5) | normals | curvature");
    const Records fewer = kept.those([&](std::size_t i) { return kept.value(i, "classification") < 7; });
    if (fewer.size() < 2) continue;
    expect_as_over(input, "knn(k=5) | voxel(0.07) | where(classification < 7) | normals", fewer, "knn(k=5) | normals");
  }
}

TEST(Voxel, SeesOnlyTheRowsThatEarlierSelectsHaveLeft) {
  for (const std::size_t shape : {0, 4, 6, 9}) {
    const Records input = with_attributes(make_cloud(hostile_shapes()[shape].second, sized(900), 36));
    const Records first = input.those([&](std::size_t i) { return input.value(i, "classification") < 6; });
    const Records kept = first.kept(one_of_each_voxel(first.positions(), 0.2, true));
    if (kept.size() < 2) continue;
    expect_as_over(input, "knn(k=4) | where(classification < 6) | voxel(0.2, keep=hash) | normals", kept,
                   "knn(k=4) | normals");
  }
}

TEST(Voxel, StandsBehindOutliersAndBeforeNormals) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[9].second, sized(900), 37));
  const Records marked = records_of(run_text(input, "knn(k=6) | sor(multiplier=1)", tiny(200)));
  const Records inliers = marked.those([&](std::size_t i) { return marked.value(i, "outlier") == 0; });
  const Records kept = inliers.kept(one_of_each_voxel(inliers.positions(), 0.05, false));
  ASSERT_LT(kept.size(), inliers.size());
  expect_as_over(input, "knn(k=6) | sor(multiplier=1) | where(outlier == 0) | voxel(0.05) | normals", kept,
                 "knn(k=6) | normals");
}

TEST(Voxel, SeesMovedPositions) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, sized(600), 38);
  const Throw mover(0.5);
  std::vector<Vec3> moved, kept;
  for (std::size_t i = 0; i < points.size(); ++i) moved.push_back(mover.moved(points[i], i));
  const std::vector<bool> keep = one_of_each_voxel(moved, 0.25, false);
  for (std::size_t i = 0; i < moved.size(); ++i)
    if (keep[i]) kept.push_back(moved[i]);
  ASSERT_LT(kept.size(), points.size());
  const RunResult expected = run_in_memory(kept, {{.k = 5}, {normals()}}, tiny(100));
  for (const EngineOptions& options : ways_to_run(Order::input)) {
    const Chain chain{{.k = 5}, {thrown(0.5), operators::voxel({0.25}), normals()}};
    const RunResult got = run_in_memory(points, chain, options);
    for (const char* field : {"x", "nx", "ny", "nz"}) EXPECT_TRUE(same_bytes(got.field(field), expected.field(field)));
  }
}

std::vector<double> kept_x(const std::vector<Vec3>& points, double size) {
  return run_in_memory(points, {{}, {operators::voxel({size})}}, tiny(100)).field("x");
}

TEST(Voxel, TheGridIsThatOfTheCoordinatesAndAFaceBelongsToTheVoxelAbove) {
  EXPECT_EQ(kept_x({{-0.5, 0, 0}, {-0.4, 0, 0}, {0, 0, 0}, {0.3, 0, 0}, {1, 0, 0}, {-1, 0, 0}}, 1),
            (std::vector<double>{-0.5, 0.3, 1}))
      << "-1 is farther from -0.5 than -0.5";
  EXPECT_EQ(kept_x({{-1, 0, 0}, {-1e-300, 0, 0}, {0, 0, 0}}, 1), (std::vector<double>{-1, 0}))
      << "equally far from the centre, the lesser x stays";
  EXPECT_EQ(kept_x({{5e6 + 0.25, 0, 0}, {5e6 + 0.75, 0, 0}, {5e6 - 0.25, 0, 0}}, 0.5),
            (std::vector<double>{5e6 + 0.25, 5e6 + 0.75, 5e6 - 0.25}));
  EXPECT_EQ(kept_x({{3, 0, 0}, {3.5, 0, 0}, {4, 0, 0}, {1e9, 0, 0}}, 1e12), (std::vector<double>{1e9}));
}

TEST(Voxel, NumbersBeyondThoseOfIntegersAndOfDoublesAreNoError) {
  EXPECT_EQ(kept_x({{1e17, 0, 0}, {1e17 + 16, 0, 0}, {1e17, 0, 0}}, 1e-3), (std::vector<double>{1e17, 1e17 + 16}));
  EXPECT_EQ(kept_x({{1e305, 0, 0}, {1e305, 0, 0}}, 1e-9).size(), 1u);
  for (const double size : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_NE(refusal([&] { operators::voxel({size}); }).find("voxel: size is a number, above 0, not "),
              std::string::npos);
  for (const char* wrong : {"voxel", "voxel(0)", "voxel(1, keep=first)", "voxel(size=1, 2)"})
    EXPECT_NE(refusal([&] { chain_of(wrong); }), "") << wrong;
}

/// Parts of a cloud that is cut at faces of the grid, with rows in any order, give the points that the whole cloud
/// gives.
TEST(Voxel, TilesAndAnyOrderOfRowsGiveTheSamePoints) {
  for (const std::size_t shape : {1, 4, 5, 12}) {
    std::vector<Vec3> points = make_cloud(hostile_shapes()[shape].second, sized(1500), 39);
    for (const char* text : {"voxel(0.125)", "voxel(0.125, keep=hash)"}) {
      const auto places = [&](const std::vector<Vec3>& part) {
        return part.empty() ? std::set<std::tuple<double, double, double>>()
                            : places_of(run_in_memory(part, chain_of(text), tiny(200)));
      };
      const auto whole = places(points);
      std::ranges::shuffle(points, std::mt19937_64(1));
      EXPECT_EQ(places(points), whole);
      std::vector<Vec3> left, right;
      for (const Vec3& p : points) (p.x - 5e6 * (shape == 12) < 0.5 ? left : right).push_back(p);
      auto parts = places(left);
      parts.merge(places(right));
      EXPECT_EQ(parts, whole);
    }
  }
}

TEST(Thinning, TheReferenceEngineGetsTheSameRows) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[0].second, 400, 40));
  const std::string text =
      "knn(k=300) | decimate(0.9) | voxel(0.1) | sor(multiplier=1) | voxel(0.3, keep=hash) | normals";
  for (const Order order : {Order::input, Order::sweep}) {
    EngineOptions options = tiny(200);
    options.engine = Engine::reference;
    options.order = order;
    const RunResult got = run_text(input, text, options);
    ASSERT_EQ(got.statistics.reference->incomplete, 0u);
    options.engine = Engine::exact;
    EXPECT_TRUE(got.records == run_text(input, text, options).records);
  }
}

TEST(Thinning, TheDryRunNamesThePasses) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[0].second, 100, 16));
  InputCloud cloud = input.cloud();
  const std::string text =
      to_text(preview(cloud, build_chain(parse_pipeline("decimate(0.5) | voxel(0.1) | normals"), cloud), tiny(100)));
  for (const char* words : {"pass 1 of 3", "1 decimate", "2 voxel", "those of a voxel together", "52 bytes a point"})
    EXPECT_NE(text.find(words), std::string::npos) << words << "\n" << text;
}

/// Voxels need no memory beyond that of ordering the points, whether a voxel holds all points or a single one.
TEST(Thinning, ABudgetThatDoesForTheOrderDoesForVoxelsOfAnySize) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[0].second, 60'000, 41));
  for (const char* text : {"voxel(1e6)", "voxel(1e-6)"}) {
    EngineOptions options = tiny(4096, true);
    options.resources.memory_bytes = 48u << 20;
    const RunResult got = run_text(input, text, options);
    EXPECT_EQ(got.statistics.points_written, std::string(text) == "voxel(1e6)" ? 8u : 60'000u);
  }
}

}  // namespace
}  // namespace pointsweep
