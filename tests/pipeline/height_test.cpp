// SPDX-License-Identifier: MIT
/// The operator height against a search through all ground points.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <tuple>

#include "pointsweep/error.h"
#include "pointsweep/operators.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

RunResult run_height(const Records& input, const std::string& pipeline, const EngineOptions& options) {
  InputCloud cloud = input.cloud();
  return run_in_memory(cloud, build_chain(parse_pipeline(pipeline), cloud), options);
}

/// Returns whether the heights are equal or both NaN.
bool same_height(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// Returns for each k the heights by the formula, over the k nearest of all ground points.
std::vector<std::vector<double>> heights_by_brute_force(const std::vector<Vec3>& points,
                                                        const std::vector<bool>& is_ground,
                                                        const std::vector<std::size_t>& all_k) {
  std::vector<std::vector<double>> heights(all_k.size());
  for (const Vec3& p : points) {
    using Key = std::tuple<double, double, double, double, std::size_t>;
    std::vector<Key> ground;
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (!is_ground[j] || !is_finite(points[j])) continue;
      const double x = points[j].x - p.x, y = points[j].y - p.y;
      ground.emplace_back(x * x + y * y, points[j].x, points[j].y, points[j].z, j);
    }
    if (ground.empty() || !is_finite(p)) {
      for (std::vector<double>& of_one_k : heights) of_one_k.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    std::ranges::sort(ground);
    for (std::size_t i = 0; i < all_k.size(); ++i) {
      double sum = 0, weights = 0;
      for (const auto& [d2, x, y, z, row] : std::span(ground).first(std::min(all_k[i], ground.size())))
        sum += 1 / d2 * z, weights += 1 / d2;
      const bool above = std::get<0>(ground[0]) == 0;
      heights[i].push_back(above ? p.z - std::get<3>(ground[0]) : p.z - sum / weights);
    }
  }
  return heights;
}

TEST(Height, IsThatAboveTheNearestGroundOfAll) {
  for (const auto& [name, shape] : hostile_shapes()) {
    for (const int ground_below : {0, 1, 6}) {  // classes that count as ground
      Records input = with_attributes(make_cloud(shape, sized(800), 71));
      std::vector<bool> is_ground;
      const Field field = input.schema.fields[*input.schema.find("classification")];
      for (std::size_t i = 0; i < input.size(); ++i) {
        const bool ground = input.value(i, "classification") < ground_below;
        is_ground.push_back(ground);
        input.bytes[i * input.schema.stride + field.offset] = std::byte(ground ? 2 : 5);
      }
      const std::vector<std::size_t> all_k = {1, 3, 100, 1000};
      const std::vector<std::vector<double>> expected = heights_by_brute_force(input.positions(), is_ground, all_k);
      for (std::size_t i = 0; i < all_k.size(); ++i) {
        for (const EngineOptions& options : ways_to_run()) {
          const RunResult got = run_height(input, fmt::format("height(k={})", all_k[i]), options);
          ASSERT_TRUE(std::ranges::equal(got.field("height"), expected[i], same_height)) << name << ", k " << all_k[i];
        }
      }
    }
  }
}

TEST(Height, ComesAfterGroundAndBeforeWhere) {
  std::mt19937_64 random(6);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < sized(4000); ++i) {
    const double x = 50 * uniform(random), y = 30 * uniform(random);
    points.push_back({x, y, 0.1 * x + (uniform(random) < 0.3 ? 6 * uniform(random) : 0)});
  }
  const Records input = with_attributes(points);
  const Records ground = records_of(run_height(input, "ground(window=6)", tiny(500)));
  std::vector<bool> is_ground;
  for (std::size_t i = 0; i < ground.size(); ++i) is_ground.push_back(ground.value(i, "classification") == 2);
  const std::vector<double> heights = heights_by_brute_force(points, is_ground, {2}).front();
  std::vector<double> low;
  for (const double h : heights)
    if (h < 2) low.push_back(h);
  ASSERT_LT(low.size(), points.size());
  for (const EngineOptions& options : ways_to_run()) {
    const RunResult got = run_height(input, "ground(window=6) | height(k=2) | where(height < 2)", options);
    EXPECT_TRUE(same_bytes(got.field("height"), low));
  }
  EngineOptions sorted = tiny(300);
  sorted.order = Order::sweep;
  const Records made = records_of(run_height(input, "ground(window=6) | height(k=2)", tiny(500)));
  EXPECT_TRUE(run_height(input, "ground(window=6) | height(k=2)", sorted).records ==
              run_height(made, "where(x > -1)", sorted).records);
}

TEST(Height, TellsWhatIsWrong) {
  const Records input = with_attributes({{0, 0, 0}, {1, 1, 1}});
  for (const char* wrong : {"height(k=0)", "height(k=2000)", "height(from=surface)"})
    EXPECT_NE(refusal([&] { run_height(input, wrong, tiny(100)); }), "") << wrong;
  const std::vector<Vec3> bare = {{0, 0, 0}, {1, 1, 1}};
  EXPECT_NE(refusal([&] {
              run_in_memory(bare, {{}, {operators::height()}}, tiny(100));
            }).find("needs 'classification'"),
            std::string::npos);
}

}  // namespace
}  // namespace pointsweep
