// SPDX-License-Identifier: MIT
/// The operator ground in pipelines, and properties of the input that must not change its classes.
/// tests/numpy/ground_test.py compares the classes with filters of whole rasters.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "pointsweep/error.h"
#include "pointsweep/operators.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/reference_engine.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

RunResult run_ground(const Records& input, const std::string& pipeline, const EngineOptions& options) {
  InputCloud cloud = input.cloud();
  return run_in_memory(cloud, build_chain(parse_pipeline(pipeline), cloud), options);
}

/// Returns hills with houses, trees and a few pits, on 60 x 40 units.
std::vector<Vec3> hills(std::size_t n, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = 60 * uniform(random) - 20, y = 40 * uniform(random);
    double z = 2 * std::sin(x / 9) + 0.1 * y + 0.05 * uniform(random);
    if (std::abs(x - 10) < 6 && std::abs(y - 20) < 4) z += 7;
    if (uniform(random) < 0.2) z += 9 * uniform(random);
    if (uniform(random) < 0.01) z -= 40;
    points.push_back({x, y, z});
  }
  return points;
}

/// Returns the classification of each row.
std::vector<double> classes(const RunResult& result) { return result.field("classification"); }

constexpr const char* kGroundText = "ground(window=9)";

/// The cloud has a plane that rises by 1/2 per unit along x or y, sampled at the centres of cells, and points above the
/// plane.
TEST(Ground, OfATiltedPlaneIsWhatLiesWithinTheThresholdAndTheScalarTimesTheSlope) {
  for (const bool along_x : {true, false}) {
    std::vector<Vec3> points;
    const auto add = [&](double x, double y, double above) {
      const double z = 0.5 * x + above;
      points.push_back(along_x ? Vec3{x, y, z} : Vec3{y, x, z});
    };
    for (int i = 0; i < 40; ++i)
      for (int j = 0; j < 30; ++j) add(i + 0.5, j + 0.5, 0);
    std::vector<double> expected(points.size(), 2);
    for (const double above : {0.2501, 0.7499, 0.7501, 3.0})
      for (const double x : {0.1, 0.4, 0.6, 0.9})
        for (const double y : {0.2, 0.8}) {
          add(10 + x, 9 + y, above);
          expected.push_back(above < 0.75 ? 2 : 1);
        }
    const auto ground = operators::ground({.cell = 1, .slope = 1, .window = 3, .threshold = 0.25, .scalar = 1});
    for (const EngineOptions& options : ways_to_run())
      EXPECT_EQ(classes(run_in_memory(points, {{}, {ground}}, options)), expected);
  }
}

/// The cloud has a block 6 cells wide and 4 high, and a pit one cell wide and 8 deep.
TEST(Ground, BlocksNarrowerThanTheWindowAndPitsAreNotGround) {
  std::vector<Vec3> points;
  std::vector<double> expected, with_narrow_window;
  for (int i = 0; i < 50; ++i)
    for (int j = 0; j < 40; ++j) {
      const bool block = i >= 20 && i < 26 && j >= 10 && j < 16, pit = i == 35 && j == 20;
      points.push_back({i + 0.5, j + 0.5, block ? 4.0 : pit ? -8.0 : 0.0});
      expected.push_back(block || pit ? 1 : 2);
      with_narrow_window.push_back(pit ? 1 : 2);
    }
  for (const EngineOptions& options : ways_to_run()) {
    const auto got = [&](double window) {
      return classes(run_in_memory(points, {{}, {operators::ground({.window = window})}}, options));
    };
    EXPECT_EQ(got(5), expected);
    EXPECT_EQ(got(1), with_narrow_window);
  }
}

TEST(Ground, NoiseKeepsItsClassAndOnlyGroundHasTheClassOfGround) {
  const Records input = with_attributes(hills(sized(4000), 13));
  const RunResult got = run_ground(input, kGroundText, tiny(500));
  const std::vector<double> found = classes(got);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < input.size(); ++i) {
    const double before = input.value(i, "classification");
    EXPECT_TRUE(found[i] == 2 ? before != 7 : found[i] == (before == 2 ? 1 : before)) << i;
    changed += before == 2 && found[i] == 1;
  }
  EXPECT_GT(changed, 0u);
  const RunResult with_noise = run_ground(input, "ground(window=9, noise=yes)", tiny(500));
  EXPECT_GT(std::ranges::count(classes(with_noise), 2), std::ranges::count(found, 2));
}

/// Points are returns 1, 2 and 3 of two returns. Only returns 2 and 3 can be ground.
TEST(Ground, OnlyLastReturnsTakePart) {
  Records input;
  for (const char* axis : {"x", "y", "z"}) input.schema.append(axis, Type::f64);
  input.schema.append("return_number", Type::u8);
  input.schema.append("number_of_returns", Type::u8);
  for (int i = 0; i < 900; ++i) {
    const double place[3] = {i % 30 + 0.5, i / 30 + 0.5, 0};
    const std::uint8_t returns[2] = {static_cast<std::uint8_t>(1 + i % 3), 2};
    const auto put = [&](const void* from, std::size_t n) {
      const auto* bytes = static_cast<const std::byte*>(from);
      input.bytes.insert(input.bytes.end(), bytes, bytes + n);
    };
    put(place, sizeof place);
    put(returns, sizeof returns);
  }
  const std::vector<double> last = classes(run_ground(input, "ground", tiny(100)));
  for (std::size_t i = 0; i < last.size(); ++i) EXPECT_EQ(last[i], i % 3 == 0 ? 1 : 2);
  const std::vector<double> all = classes(run_ground(input, "ground(returns=all)", tiny(100)));
  EXPECT_EQ(std::ranges::count(all, 2), 900);
}

TEST(Ground, HasTheSameBytesWithAnyThreadsMemorySlabsAndAxis) {
  const Records input = with_attributes(hills(sized(6000), 1));
  const RunResult expected = run_ground(input, kGroundText, tiny(1000));
  EXPECT_GT(std::ranges::count(classes(expected), 2), 1000);
  for (const EngineOptions& options : ways_to_run())
    EXPECT_TRUE(run_ground(input, kGroundText, options).records == expected.records);
}

TEST(Ground, DoesNotDependOnTheOrderOfRows) {
  std::vector<Vec3> points = hills(sized(5000), 2);
  const auto found = [&] {
    std::vector<std::pair<double, double>> ground;
    const RunResult got = run_in_memory(points, {{}, {operators::ground({.window = 9})}}, tiny(500));
    const std::vector<double> x = got.field("x"), c = classes(got);
    for (std::size_t i = 0; i < x.size(); ++i) ground.emplace_back(x[i], c[i]);
    std::ranges::sort(ground);
    return ground;
  };
  const auto expected = found();
  std::ranges::shuffle(points, std::mt19937_64(3));
  EXPECT_TRUE(found() == expected);
}

TEST(Ground, InSweepOrderHasTheClassesOfInputOrder) {
  const Records input = with_attributes(hills(sized(4000), 3));
  const Records made = records_of(run_ground(input, kGroundText, tiny(300)));
  EngineOptions sorted = tiny(300);
  sorted.order = Order::sweep;
  const RunResult expected = run_ground(made, "where(x > -1e300)", sorted);
  EXPECT_TRUE(run_ground(input, kGroundText, sorted).records == expected.records);
}

TEST(Ground, SeesTheRowsThatAreLeft) {
  const Records input = with_attributes(hills(sized(5000), 4));
  const Records left = input.those([&](std::size_t i) { return input.value(i, "classification") < 6; });
  for (const EngineOptions& options : ways_to_run())
    EXPECT_TRUE(run_ground(input, "where(classification < 6) | ground(window=9)", options).records ==
                run_ground(left, kGroundText, options).records);
}

TEST(Ground, OfAnEarlierGroundReadsItsClasses) {
  const Records input = with_attributes(hills(sized(3000), 5));
  const RunResult once = run_ground(input, kGroundText, tiny(500));
  const RunResult expected = run_ground(records_of(once), "ground(window=4)", tiny(500));
  EXPECT_TRUE(run_ground(input, "ground(window=9) | ground(window=4)", tiny(500)).records == expected.records);
}

TEST(Ground, LaterStagesReadItsClasses) {
  const Records input = with_attributes(hills(sized(4000), 6));
  const Records made = records_of(run_ground(input, kGroundText, tiny(500)));
  const Records ground = made.those([&](std::size_t i) { return made.value(i, "classification") == 2; });
  for (const EngineOptions& options : ways_to_run()) {
    const RunResult got =
        run_ground(input, "knn(k=6) | ground(window=9) | where(classification == 2) | normals", options);
    const RunResult expected = run_ground(ground, "knn(k=6) | normals", options);
    EXPECT_TRUE(same_bytes(got.field("nz"), expected.field("nz")));
    EXPECT_EQ(got.field("id"), expected.field("id"));
  }
}

TEST(Ground, StandsBetweenStagesThatSearch) {
  const Records input = with_attributes(hills(sized(3000), 7));
  const RunResult ground = run_ground(input, kGroundText, tiny(400));
  const RunResult shape = run_ground(input, "knn(k=7) | normals | sor", tiny(400));
  for (const char* text : {"knn(k=7) | normals | ground(window=9) | sor", "knn(k=7) | ground(window=9) | normals | sor",
                           "knn(k=7) | normals | sor | ground(window=9)"})
    for (const EngineOptions& options : ways_to_run()) {
      const RunResult got = run_ground(input, text, options);
      EXPECT_EQ(classes(got), classes(ground)) << text;
      for (const char* field : {"nx", "mean_distance", "outlier"})
        EXPECT_TRUE(same_bytes(got.field(field), shape.field(field))) << text << " " << field;
    }
}

TEST(Ground, SeesMovedPositions) {
  const std::vector<Vec3> points = hills(sized(3000), 8);
  const Throw mover(0.5);
  std::vector<Vec3> moved;
  for (std::size_t i = 0; i < points.size(); ++i) moved.push_back(mover.moved(points[i], i));
  const auto ground = operators::ground({.window = 9});
  const RunResult expected = run_in_memory(moved, {{}, {ground}}, tiny(300));
  for (const EngineOptions& options : ways_to_run())
    EXPECT_EQ(classes(run_in_memory(points, {{.k = 5}, {thrown(0.5), ground}}, options)), classes(expected));
}

TEST(Ground, APointWithoutAFinitePlaceIsUnclassified) {
  std::vector<Vec3> points = hills(500, 9);
  points[3].z = std::nan("");
  points[7].x = HUGE_VAL;
  const RunResult got = run_in_memory(points, {{}, {operators::ground()}}, tiny(100));
  EXPECT_EQ(classes(got)[3], 1);
  EXPECT_EQ(classes(got)[7], 1);
}

TEST(Ground, TheReferenceEngineGetsTheSameClasses) {
  const Records input = with_attributes(hills(600, 10));
  EngineOptions options = tiny(200);
  const RunResult expected = run_ground(input, "ground(window=5)", options);
  options.engine = Engine::reference;
  EXPECT_TRUE(run_ground(input, "ground(window=5)", options).records == expected.records);
}

/// The raster would have 1e9 columns if empty rows and columns were stored.
TEST(Ground, APointFarAwayChangesNoOtherPoint) {
  std::vector<Vec3> points = hills(sized(3000), 11);
  const auto ground = operators::ground({.window = 9});
  std::vector<double> expected = classes(run_in_memory(points, {{}, {ground}}, tiny(300)));
  points.push_back({1e9, -1e9, 0});
  expected.push_back(2);
  for (const EngineOptions& options : ways_to_run())
    EXPECT_EQ(classes(run_in_memory(points, {{}, {ground}}, options)), expected);
}

/// A single raster of all points would have more than 1e9 cells, nearly all of them empty.
TEST(Ground, ManyPointsFarFromEachOtherCostLittleAndChangeNoOtherPoint) {
  std::vector<Vec3> points = hills(sized(1500), 11);
  const auto ground = operators::ground({.window = 9});
  std::vector<double> expected = classes(run_in_memory(points, {{}, {ground}}, tiny(300)));
  for (int i = 1; i <= 500; ++i) points.push_back({1e4 * i, -2e4 * i, 10.0 * (i % 7)});
  expected.resize(points.size(), 2);
  EngineOptions options = tiny(300);
  options.resources.memory_bytes = 48u << 20;
  EXPECT_EQ(classes(run_in_memory(points, {{}, {ground}}, options)), expected);
}

/// The cloud has two sheets. The first has a bank at its edge towards the second. If cells of the gap were filled, the
/// bank would look narrow.
TEST(Ground, DoesNotDependOnPointsBeyondItsReach) {
  for (const bool along_x : {true, false}) {
    const auto add_sheet = [&](std::vector<Vec3>& points, int from, int to, double z) {
      for (int i = from; i < to; ++i)
        for (int j = 0; j < 30; ++j) {
          const Vec3 p{i + 0.5, j + 0.5, i == 18 || i == 19 ? 3.0 : z};
          points.push_back(along_x ? p : Vec3{p.y, p.x, p.z});
        }
    };
    const auto ground = operators::ground({.window = 2});
    std::vector<Vec3> near;
    add_sheet(near, 0, 20, 0);
    const std::vector<double> alone = classes(run_in_memory(near, {{}, {ground}}, tiny(700)));
    for (const int gap : {22, 25, 60}) {
      std::vector<Vec3> both = near;
      add_sheet(both, 20 + gap, 40 + gap, -5);
      std::vector<double> found = classes(run_in_memory(both, {{}, {ground}}, tiny(700)));
      found.resize(near.size());
      EXPECT_EQ(found, alone) << "a gap of " << gap;
    }
  }
}

TEST(Ground, TellsWhatIsWrong) {
  const Records input = with_attributes({{0, 0, 0}, {1, 1, 1}});
  for (const char* wrong : {"ground(cell=0)", "ground(cell=-1)", "ground(slope=-1)", "ground(method=pmf)",
                            "ground(window=1e6)", "ground(returns=first)", "ground(size=1)"})
    EXPECT_NE(refusal([&] { run_ground(input, wrong, tiny(100)); }), "") << wrong;
  for (const double wrong : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_NE(refusal([&] { operators::ground({.cell = wrong}); }).find("ground: cell is a number, above 0, not "),
              std::string::npos);
}

/// The filter would hold 20,000 columns of cells, each for as many rows as the largest disk has.
TEST(Ground, RowsThatMemoryCannotHoldAreRefusedInAdvance) {
  std::mt19937_64 random(12);
  std::vector<Vec3> points;
  for (int i = 0; i < 60'000; ++i) points.push_back({3e4 * uniform(random), 2e4 * uniform(random), uniform(random)});
  const Records input = with_attributes(points);
  EngineOptions options = tiny(16384, true);
  options.resources.memory_bytes = 96u << 20;
  std::string refused;
  try {
    run_ground(input, "ground(window=100)", options);
  } catch (const Error& error) {
    refused = error.what();
  }
  EXPECT_NE(refused.find("give --memory"), std::string::npos) << refused;
}

}  // namespace
}  // namespace pointsweep
