// SPDX-License-Identifier: MIT
/// The operator components against flood fill over all pairs.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <tuple>

#include "pointsweep/error.h"
#include "pointsweep/operators.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/brute_components.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

Labels of_nearest(const std::vector<Vec3>& points, std::size_t k) {
  Sets sets(points.size());
  const auto lists = nearest_rows(points, k);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const std::size_t j : lists[i]) sets.join(i, j);
  return sets.labels(points);
}

Labels within(const std::vector<Vec3>& points, double distance) {
  Sets sets(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (distance2(points[i], points[j]) <= distance * distance) sets.join(i, j);
  return sets.labels(points);
}

Labels run_components(const Records& input, const std::string& pipeline, const EngineOptions& options) {
  const RunResult got = run_text(input, pipeline, options);
  return {got.field("component"), got.field("component_size")};
}

TEST(Components, OfNearestNeighborsAreThoseOfAllPairs) {
  std::size_t turn = 0;
  for (const auto& [name, shape] : hostile_shapes()) {
    const Records input = with_attributes(make_cloud(shape, sized(700), 81));
    for (const std::size_t k : {1u, 2u, 8u}) {
      const Labels expected = of_nearest(input.positions(), k);
      for (const EngineOptions& options : half_of_ways_to_run(turn++))
        ASSERT_EQ(run_components(input, fmt::format("knn(k={}) | components", k), options), expected)
            << name << ", k = " << k;
    }
  }
}

TEST(Components, WithinADistanceAreThoseOfAllPairs) {
  std::size_t turn = 0;
  for (const auto& [name, shape] : hostile_shapes()) {
    const Records input = with_attributes(make_cloud(shape, sized(700), 82));
    for (const double distance : {0.0, 0.002, 0.03, 0.2, 1.0}) {
      const Labels expected = within(input.positions(), distance);
      for (const EngineOptions& options : half_of_ways_to_run(turn++)) {
        const std::string text = fmt::format("knn(radius={0}) | components(distance={0})", distance);
        ASSERT_EQ(run_components(input, text, options), expected) << name << ", distance " << distance;
      }
      const std::string wider = fmt::format("knn(radius={}) | components(distance={})", 2 * distance, distance);
      ASSERT_EQ(run_components(input, wider, tiny(100)), expected) << name << ", distance " << distance;
    }
  }
}

/// The cloud has a chain through all of it, a comb along each axis whose teeth join at one end, and single points.
TEST(Components, JoinWhatMeetsAtTheEndOfTheCloud) {
  std::vector<Vec3> points;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < 400; ++i) {
      for (int tooth = 0; tooth < 6; ++tooth) {
        Vec3 p{1000.0 * axis, 0, 0};
        p[axis] += i;
        p[(axis + 1) % 3] += 5 * tooth;
        points.push_back(p);
      }
    }
    for (int i = 0; i < 25; ++i) {
      Vec3 p{1000.0 * axis, 0, 0};
      p[axis] += axis == 1 ? 0 : 399;
      p[(axis + 1) % 3] += i + 0.5;
      points.push_back(p);
    }
  }
  for (int i = 0; i < 7; ++i) points.push_back({-100.0 * i, 77, 77});
  const Labels expected = within(points, 1);
  EXPECT_EQ(*std::ranges::max_element(expected.component), 9);
  std::mt19937_64 random(3);
  for (int turn = 0; turn < 2; ++turn) {
    for (const EngineOptions& options : ways_to_run())
      EXPECT_EQ(run_components(with_attributes(points), "knn(radius=1) | components(distance=1)", options),
                within(points, 1));
    std::ranges::shuffle(points, random);
  }
}

/// Later stages see the numbers of components; earlier stages may run in the same sweep.
TEST(Components, StandBetweenOtherStages) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[9].second, sized(3000), 83));
  const RunResult alone = run_text(input, "knn(k=2) | components", tiny(300));
  const RunResult with_normals = run_text(input, "knn(k=2) | normals | components | curvature", tiny(300));
  const RunResult first = run_text(input, "knn(k=2) | components | normals | curvature", tiny(300, true));
  const RunResult plain = run_text(input, "knn(k=2) | normals | curvature", tiny(300));
  for (const RunResult* other : {&with_normals, &first}) {
    EXPECT_EQ(other->field("component"), alone.field("component"));
    EXPECT_EQ(other->field("component_size"), alone.field("component_size"));
    for (const char* field : {"nx", "ny", "nz", "k1"}) EXPECT_EQ(other->field(field), plain.field(field)) << field;
  }
  const std::vector<double> sizes = alone.field("component_size");
  const Records large = input.those([&](std::size_t i) { return sizes[i] > 10; });
  ASSERT_LT(large.size(), input.size());
  ASSERT_GT(large.size(), 0u);
  const std::string rest = "sor | where(outlier == 0) | reneighbor(k=4) | components";
  for (const EngineOptions& options : ways_to_run()) {
    const RunResult kept = run_text(
        input, "knn(k=2) | components | where(component_size > 10) | reneighbor(k=4) | normals", options, {"normal"});
    EXPECT_EQ(kept.field("nx"), run_text(large, "knn(k=4) | normals", options, {"normal"}).field("nx"));
    EXPECT_EQ(run_text(input, "knn(k=2) | " + rest, options).field("component"),
              run_text(input, "knn(k=2) | " + rest, tiny(50'000)).field("component"));
  }
}

TEST(Components, HaveTheSameBytesInBothOrders) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[13].second, sized(3000), 84));
  for (const char* pipeline : {"knn(k=3) | components", "knn(k=3) | normals | components"}) {
    std::vector<std::vector<std::byte>> outputs;
    for (EngineOptions options : ways_to_run()) {
      options.axis = 1;
      options.order = Order::sweep;
      outputs.push_back(run_text(input, pipeline, options).records);
      EXPECT_EQ(outputs.back(), outputs.front());
    }
    std::map<double, std::pair<double, double>> by_id;
    const RunResult by_row = run_text(input, pipeline, tiny(300));
    EngineOptions options = tiny(300);
    options.order = Order::sweep;
    const RunResult by_place = run_text(input, pipeline, options);
    const auto low = [](const RunResult& r) {
      std::vector<std::tuple<double, double, double>> all;
      const auto x = r.field("x"), component = r.field("component"), size = r.field("component_size");
      for (std::size_t i = 0; i < x.size(); ++i)
        if (std::isfinite(x[i])) all.emplace_back(x[i], component[i], size[i]);
      std::ranges::sort(all);
      return all;
    };
    EXPECT_EQ(low(by_row), low(by_place));
  }
}

TEST(Components, AskForListsThatHoldWhatTheyJoin) {
  const Records input = with_attributes({{0, 0, 0}, {1, 0, 0}});
  EXPECT_EQ(
      refusal([&] { run_text(input, "knn(k=8) | components(distance=2)", tiny(100)); }),
      "pipeline, column 12: components: needs more neighbours than the 8 nearest; write knn(radius=2) before it.");
  EXPECT_THROW(operators::components({-1.0}), UsageError);
  for (const char* pipeline : {"components", "knn(radius=1) | components(distance=0.5)"}) {
    const Labels one = run_components(with_attributes({{3, 4, 5}}), pipeline, tiny(100));
    EXPECT_EQ(one.component, std::vector<double>{0});
    EXPECT_EQ(one.size, std::vector<double>{1});
  }
}

}  // namespace
}  // namespace pointsweep
