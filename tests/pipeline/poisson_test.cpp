// SPDX-License-Identifier: MIT
/// The operator poisson against the sequential greedy loop over the whole cloud.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <set>
#include <tuple>

#include "pointsweep/cancellation.h"
#include "pointsweep/error.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/thinning/undecided_points.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/pipeline/plain_hash.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/reference_engine.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

std::uint64_t disk_hash(const Vec3& p) { return plain_hash({p.x, p.y, p.z}, 0x706f6973736f6e); }

/// Returns which points the greedy loop keeps: each point in order is compared with all kept points.
std::vector<bool> greedy(const std::vector<Vec3>& points, const std::vector<double>& radius) {
  std::vector<std::size_t> order(points.size()), kept;
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::size_t i) {
    return std::tuple(disk_hash(points[i]), points[i].x, points[i].y, points[i].z, i);
  };
  std::vector<bool> keep(points.size(), true);
  std::erase_if(order, [&](std::size_t i) { return !is_finite(points[i]); });
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  for (const std::size_t i : order) {
    keep[i] = std::ranges::none_of(kept, [&](std::size_t j) {
      const double x = points[i].x - points[j].x, y = points[i].y - points[j].y, z = points[i].z - points[j].z;
      return x * x + y * y + z * z <= radius[i] * radius[i];
    });
    if (keep[i]) kept.push_back(i);
  }
  return keep;
}

std::vector<bool> greedy(const std::vector<Vec3>& points, double radius) {
  return greedy(points, std::vector<double>(points.size(), radius));
}

TEST(Poisson, KeepsWhatTheGreedyLoopKeeps) {
  for (const auto& [name, shape] : hostile_shapes()) {
    for (const double radius : {1e-9, 0.003, 0.06, 0.4, 5.0, 1e4}) {
      SCOPED_TRACE(fmt::format("{}, radius {}", name, radius));
      const Records input = with_attributes(make_cloud(shape, sized(700), 51));
      const Records kept = input.kept(greedy(input.positions(), radius));
      for (const EngineOptions& options : ways_to_run(Order::input)) {
        const RunResult got = run_text(input, fmt::format("poisson({})", radius), options);
        ASSERT_TRUE(got.records == kept.bytes);
        EXPECT_EQ(got.statistics.sweeps, 0u);
      }
    }
  }
}

/// Clouds with several batches of undecided points and chains of waiting points, in two orders of the rows.
TEST(Poisson, AnyOrderOfRowsAndAnyAxisGiveTheGreedyChoice) {
  for (const std::size_t shape : {1, 3, 6, 7, 10}) {
    std::vector<Vec3> points = make_cloud(hostile_shapes()[shape].second, sized(9000), 52);
    for (const double radius : {0.01, 0.05}) {
      const auto places = [&](int axis) {
        EngineOptions options = tiny(3000);
        options.axis = axis;
        const RunResult got = run_in_memory(points, {{}, {operators::poisson({radius})}}, options);
        const std::vector<double> x = got.field("x"), y = got.field("y"), z = got.field("z");
        std::multiset<std::tuple<double, double, double>> all;
        for (std::size_t i = 0; i < x.size(); ++i) all.emplace(x[i], y[i], z[i]);
        return all;
      };
      std::multiset<std::tuple<double, double, double>> expected;
      const std::vector<bool> keep = greedy(points, radius);
      for (std::size_t i = 0; i < points.size(); ++i)
        if (keep[i]) expected.emplace(points[i].x, points[i].y, points[i].z);
      for (const int axis : {0, 1, 2}) EXPECT_TRUE(places(axis) == expected) << shape << " " << radius << " " << axis;
      std::ranges::shuffle(points, std::mt19937_64(2));
      EXPECT_TRUE(places(0) == expected);
    }
  }
}

/// Hashes ascend or descend along a line of points, so that decisions travel along the whole axis, in one case
/// backwards.
TEST(Poisson, AChainThroughTheWholeCloudIsDecidedExactly) {
  for (const bool backwards : {false, true}) {
    std::vector<Vec3> points;
    for (double x = 0; points.size() < 400; x += 0.001) {
      const Vec3 p{x, 0, 0};
      const double share = std::ldexp(static_cast<double>(disk_hash(p) >> 11), -53);
      const double least = static_cast<double>(points.size()) / 400;
      if (std::abs(share - (backwards ? 1 - least : least)) < 0.002) points.push_back(p);
    }
    const double radius = 1.5 * points.back().x / 400;
    const std::vector<bool> keep = greedy(points, radius);
    std::vector<double> expected;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (keep[i]) expected.push_back(points[i].x);
    for (const EngineOptions& options : ways_to_run(Order::input))
      EXPECT_EQ(run_in_memory(points, {{}, {operators::poisson({radius})}}, options).field("x"), expected);
  }
}

std::vector<double> gains(const Records& input, double limit) {
  std::vector<double> radius;
  for (std::size_t i = 0; i < input.size(); ++i) {
    const double gain = input.value(i, "gain");
    radius.push_back(gain > 0 ? std::min(gain, limit) : 0);
  }
  return radius;
}

TEST(Poisson, EachPointHasTheRadiusOfItsAttribute) {
  for (const auto& [name, shape] : hostile_shapes()) {
    for (const double limit : {0.3, 2.0}) {
      SCOPED_TRACE(name);
      const Records input = with_attributes(make_cloud(shape, sized(700), 53));
      const Records kept = input.kept(greedy(input.positions(), gains(input, limit)));
      for (const EngineOptions& options : ways_to_run(Order::input))
        ASSERT_TRUE(run_text(input, fmt::format("poisson({}, radius_from=gain)", limit), options).records ==
                    kept.bytes);
    }
  }
}

TEST(Poisson, TheRadiusMayComeFromAnEarlierStage) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[10].second, sized(900), 54));
  const Records made = records_of(run_text(input, "knn(k=7) | normals | neighborhood_size", tiny(200)));
  for (const char* name : {"neighbor_radius", "nz"}) {
    std::vector<double> radius;
    for (std::size_t i = 0; i < made.size(); ++i) {
      const double value = made.value(i, name);
      radius.push_back(value > 0 ? std::min(value, 0.2) : 0);
    }
    const Records kept = made.kept(greedy(made.positions(), radius));
    ASSERT_LT(kept.size(), made.size());
    for (const Order order : {Order::input, Order::sweep}) {
      const RunResult sorted = run_text(kept, "where(x > -1e300)", ways_to_run(order)[0]);
      for (const EngineOptions& options : ways_to_run(order)) {
        if (order == Order::sweep && options.axis) continue;
        const RunResult got = run_text(
            input, fmt::format("knn(k=7) | normals | neighborhood_size | poisson(0.2, radius_from={})", name), options);
        EXPECT_TRUE(got.records == sorted.records);
      }
    }
  }
}

TEST(Poisson, LeavesTheCloudOfTheKeptRowsForAllLaterStages) {
  for (const std::size_t shape : {0, 1, 5, 6, 9, 11, 13}) {
    const Records input = with_attributes(make_cloud(hostile_shapes()[shape].second, sized(800), 55));
    const Records first = input.those([&](std::size_t i) { return input.value(i, "classification") < 8; });
    const Records kept = first.kept(greedy(first.positions(), 0.04));
    if (kept.size() < 2) continue;
    for (const Order order : {Order::input, Order::sweep}) {
      for (const EngineOptions& options : ways_to_run(order)) {
        const RunResult expected = run_text(kept, "knn(k=5) | normals | curvature", options);
        const RunResult got =
            run_text(input, "knn(k=5) | where(classification < 8) | poisson(0.04) | normals | curvature", options);
        ASSERT_TRUE(got.records == expected.records) << shape;
      }
    }
  }
}

TEST(Poisson, SeesMovedPositions) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, sized(600), 56);
  const Throw mover(0.5);
  std::vector<Vec3> moved, kept;
  for (std::size_t i = 0; i < points.size(); ++i) moved.push_back(mover.moved(points[i], i));
  const std::vector<bool> keep = greedy(moved, 0.2);
  for (std::size_t i = 0; i < moved.size(); ++i)
    if (keep[i]) kept.push_back(moved[i]);
  const RunResult expected = run_in_memory(kept, {{.k = 5}, {normals()}}, tiny(100));
  for (const EngineOptions& options : ways_to_run(Order::input)) {
    const Chain chain{{.k = 5}, {thrown(0.5), operators::poisson({0.2}), normals()}};
    const RunResult got = run_in_memory(points, chain, options);
    for (const char* field : {"x", "nx", "ny", "nz"}) EXPECT_TRUE(same_bytes(got.field(field), expected.field(field)));
  }
}

TEST(Poisson, TheReferenceEngineGetsTheSameRows) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[0].second, 400, 57));
  for (const char* text :
       {"poisson(0.05)", "poisson(0.4, radius_from=gain)", "knn(k=400) | poisson(0.05) | sor(multiplier=1)",
        "knn(k=400) | poisson(0.05) | sor(multiplier=1) | poisson(0.4, radius_from=gain) | normals"}) {
    EngineOptions options = tiny(200);
    const RunResult expected = run_text(input, text, options);
    options.engine = Engine::reference;
    const RunResult got = run_text(input, text, options);
    EXPECT_EQ(got.statistics.reference ? got.statistics.reference->incomplete : 0, 0u) << text;
    EXPECT_EQ(got.records.size(), expected.records.size()) << text;
    EXPECT_TRUE(got.records == expected.records) << text;
  }
}

TEST(Poisson, TellsWhatIsWrong) {
  const Records input = with_attributes({{0, 0, 0}, {1, 1, 1}});
  for (const char* wrong : {"poisson", "poisson(0)", "poisson(-1)", "poisson(0.1, radius=2)"})
    EXPECT_NE(refusal([&] { run_text(input, wrong, tiny(100)); }), "") << wrong;
  EXPECT_NE(refusal([&] { run_text(input, "poisson(1, radius_from=gian)", tiny(100)); }).find("radius_from=gian: "),
            std::string::npos);
  for (const double radius : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_NE(refusal([&] { operators::poisson({radius}); }).find("poisson: radius is a number, above 0, not "),
              std::string::npos);
  for (const double radius : {1e-170, 1e170})
    EXPECT_NE(refusal([&] { operators::poisson({radius}); }).find("scale the coordinates"), std::string::npos);
}

/// A radius as long as the cloud needs memory for the whole cloud. It is refused before the work, with the least memory
/// that suffices.
TEST(Poisson, ARadiusThatMemoryCannotHoldIsRefusedInAdvance) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[1].second, 400'000, 58));
  EngineOptions options = tiny(16384, true);
  options.resources.memory_bytes = 64u << 20;
  EXPECT_GT(run_text(input, "poisson(0.01)", options).statistics.points_written, 1000u);
  std::string refused;
  try {
    run_text(input, "poisson(0.9)", options);
  } catch (const Error& error) {
    refused = error.what();
  }
  EXPECT_NE(refused.find("give --memory"), std::string::npos) << refused;
}

TEST(Simplify, KeepsWhatTheGreedyLoopKeepsWithRadiiOfTheCurvature) {
  for (const std::size_t shape : {0, 3, 9, 10, 13}) {
    const Records input = with_attributes(make_cloud(hostile_shapes()[shape].second, sized(900), 60));
    const Records made = records_of(run_text(input, "knn(k=9) | normals | curvature", tiny(200)));
    std::vector<double> radius;
    for (std::size_t i = 0; i < made.size(); ++i)
      radius.push_back(std::max(0.01, std::min(0.3, std::sqrt(2 * 0.002 / made.value(i, "k1")))));
    const Records kept = made.kept(greedy(made.positions(), radius));
    ASSERT_LT(kept.size(), made.size());
    for (const EngineOptions& options : ways_to_run(Order::input)) {
      const RunResult got =
          run_text(input, "knn(k=9) | normals | curvature | simplify(0.002, most=0.3, least=0.01)", options);
      for (const char* field : {"x", "y", "k1", "nx"}) {
        std::vector<double> expected;
        for (std::size_t i = 0; i < kept.size(); ++i) expected.push_back(kept.value(i, field));
        EXPECT_TRUE(same_bytes(got.field(field), expected)) << shape << " " << field;
      }
    }
  }
}

/// The cloud has a plane and a sphere of equal area and density.
TEST(Simplify, KeepsFewPointsOnFlatParts) {
  std::vector<Vec3> points;
  std::mt19937_64 random(61);
  for (const Vec3& p : make_cloud(hostile_shapes()[1].second, 4000, 62)) points.push_back({p.x, p.y * 0.5, 0});
  std::normal_distribution<double> g;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 v{g(random), g(random), g(random)};
    points.push_back(Vec3{3, 0, 0} + (0.2 / length(v)) * v);
  }
  const std::vector<double> x =
      run_in_memory(points, chain_of("knn(k=24) | normals | curvature | simplify(0.002, most=0.3)"), tiny(1000))
          .field("x");
  const auto on_plane = std::ranges::count_if(x, [](double c) { return c < 2; });
  EXPECT_GT(on_plane, 5);
  EXPECT_LT(on_plane, 60) << "radius 0.3 inside, less at the edges";
  const double on_sphere = static_cast<double>(x.size()) - static_cast<double>(on_plane);
  EXPECT_NEAR(on_sphere, 0.7 * 0.5 / (0.028 * 0.028), 150) << "about 0.7 disks to a square of the radius";
}

TEST(Simplify, HasRadiiOf32ErrorsOnFlatPartsUnlessTheyAreGiven) {
  std::vector<Vec3> points;
  for (const Vec3& p : make_cloud(hostile_shapes()[1].second, 4000, 63)) points.push_back({p.x, p.y, 0});
  const std::string text = "normals | curvature | simplify(error=0.005";
  const RunResult without = run_in_memory(points, chain_of(text + ")"), tiny(1000));
  EXPECT_TRUE(without.records == run_in_memory(points, chain_of(text + ", most=0.16)"), tiny(1000)).records);
  EXPECT_FALSE(without.records == run_in_memory(points, chain_of(text + ", most=0.15)"), tiny(1000)).records);
}

TEST(Simplify, TellsWhatIsWrong) {
  const Records input = with_attributes({{0, 0, 0}, {1, 1, 1}});
  EXPECT_NE(refusal([&] { run_text(input, "normals | simplify(0.1, most=1)", tiny(100)); }).find("needs 'k1'"),
            std::string::npos);
  EXPECT_NE(refusal([&] {
              chain_of("normals | curvature | simplify(0.1, most=1, least=2)");
            }).find("simplify: least is 2, but most"),
            std::string::npos);
  for (const char* wrong :
       {"simplify", "simplify(most=1)", "simplify(0)", "simplify(0, most=1)", "simplify(0.1, most=-1)"})
    EXPECT_NE(refusal([&] { chain_of(wrong); }), "") << wrong;
}

/// The held points are a slice of about two radii, for any number of points.
TEST(UndecidedPoints, HoldASliceBehindTheFront) {
  std::vector<Vec3> points = make_cloud(hostile_shapes()[1].second, 30'000, 59);
  std::ranges::sort(points, {}, &Vec3::x);
  for (const double radius : {0.01, 0.05, 0.1}) {
    UndecidedPoints held(0, radius, points.size());
    Findings findings;
    std::uint64_t most = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      held.hold({points[i], disk_hash(points[i]), i, radius * radius});
      held.decide(findings);
      most = std::max(most, held.held());
    }
    held.finish(findings);
    EXPECT_EQ(held.held(), 0u);
    EXPECT_LT(static_cast<double>(most), 30'000 * 2 * radius + 256) << radius;
    UndecidedPoints few(0, radius, most - 1);
    EXPECT_THROW(
        {
          for (std::size_t i = 0; i < points.size(); ++i) {
            few.hold({points[i], disk_hash(points[i]), i, radius * radius});
            few.decide(findings);
          }
        },
        Error);
  }
}

/// Decisions about a slice of the cloud equal those about the whole cloud.
TEST(UndecidedPoints, StayOpenWhereMissingPointsMayDecide) {
  for (const double radius : {0.01, 0.03, 0.06}) {
    std::vector<Vec3> points = make_cloud(hostile_shapes()[1].second, 30'000, 59);
    std::ranges::sort(points, {}, &Vec3::x);
    Findings of_all, of_slice;
    UndecidedPoints all(0, radius, points.size()), slice(0, radius, points.size());
    const double low = 0.3, high = 0.7;
    std::uint64_t held = 0, near_the_rim = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const DiskPoint point{points[i], disk_hash(points[i]), i, radius * radius};
      all.hold(point);
      all.decide(of_all);
      if (points[i].x < low || points[i].x > high) continue;
      const double rim = std::min(points[i].x - low, high - points[i].x);
      ++held, near_the_rim += rim <= 2 * radius;
      slice.hold(point, rim <= radius);
      slice.decide(of_slice);
    }
    all.finish(of_all);
    slice.finish(of_slice);
    EXPECT_TRUE(of_all.undecided.empty());
    EXPECT_GT(of_slice.undecided.size(), 0u);
    EXPECT_LT(of_slice.undecided.size(), near_the_rim) << "of " << held;
    const auto is_in = [](std::vector<std::uint64_t>& rows, std::uint64_t row) {
      return std::ranges::binary_search(rows, row);
    };
    for (std::vector<std::uint64_t>* rows : {&of_all.dropped, &of_slice.dropped, &of_slice.undecided})
      std::ranges::sort(*rows);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (points[i].x >= low && points[i].x <= high && !is_in(of_slice.undecided, i)) {
        EXPECT_EQ(is_in(of_slice.dropped, i), is_in(of_all.dropped, i)) << i;
      }
  }
}

TEST(UndecidedPoints, StopWhenTheRunIsCancelled) {
  UndecidedPoints held(0, 1, 1000);
  for (std::uint64_t row = 0; row < 100; ++row) held.hold({{0, 0, 0.01 * static_cast<double>(row)}, row, row, 1});
  CancellationToken token;
  token.cancel();
  const CancellationScope scope(&token);
  Findings findings;
  EXPECT_THROW(held.finish(findings), Cancelled);
}

}  // namespace
}  // namespace pointsweep
