// SPDX-License-Identifier: MIT
/// The one rule of all radii: a point counts within R if d² = ((dx² + dy²) + dz²) <= R·R in double. Each option of the
/// registry that means a radius is tried at the least R that holds a neighbour, and one unit in the last place on both
/// sides of it.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "tests/pipeline/attribute_cloud.h"
#include "tests/support/radius_pipelines.h"
#include "tests/support/reference_engine.h"

namespace pointsweep {
namespace {

constexpr std::size_t kRadiusPoints = 8;

class RadiusRule : public testing::Test {
 protected:
  RadiusRule() : other_(testing::TempDir() + fmt::format("pointsweep-radius-{}.csv", getpid())) {}
  ~RadiusRule() override { std::filesystem::remove(other_); }

  /// Runs over the pair and points far away, so that slabs lie between. The second point of the pair also is the other
  /// cloud.
  RunResult made(const PairAtRadius& pair, const std::string& text, double radius,
                 Engine engine = Engine::exact) const {
    std::ofstream(other_) << fmt::format("x,y,z,label\n{},{},{},1\n", pair.q.x, pair.q.y, pair.q.z);
    std::vector<Vec3> points = {pair.p, pair.q};
    for (int i = 1; points.size() < kRadiusPoints; ++i)
      points.push_back(pair.p + Vec3{1e3 * i, 2e3 * (i % 2 == 0 ? i : -i), 0});
    Records input;
    for (const char* name : {"x", "y", "z", "own"}) input.schema.append(name, Type::f64);
    for (const char* name : {"nx", "ny", "nz", "k1"}) input.schema.append(name, Type::f32);
    input.bytes.resize(points.size() * input.schema.stride);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double values[] = {points[i].x, points[i].y, points[i].z, radius, 0, 0, 1, 1};
      for (std::size_t f = 0; f < input.schema.fields.size(); ++f)
        set_value(input.schema.fields[f], input.bytes.data() + i * input.schema.stride, values[f]);
    }
    EngineOptions options;
    options.slab_points = 1;
    options.engine = engine;
    return run_text(input, radius_pipeline(text, radius, other_), options);
  }

  std::string other_;
};

/// Returns whether the output shows that the second point of the pair counts as a neighbour of the first.
bool holds(const RunResult& made, double radius) {
  const auto first = [&](const char* field) {
    return made.schema.find(field) ? std::optional(made.field(field).front()) : std::nullopt;
  };
  for (const char* size : {"component_size", "segment_size", "cluster_size"})
    if (const auto points = first(size)) return points == 2;
  if (const auto count = first("neighbor_count")) return count == 1;
  if (const auto outlier = first("outlier")) return outlier == 0;
  if (const auto density = first("surface_density")) return *density * M_PI * radius * radius > 1.5;
  if (const auto distance = first("cloud_distance")) return !std::isnan(*distance);
  if (const auto label = first("label")) return label == 1;
  if (const auto count = first("m3c2_samples2")) return count == 1;
  return made.field("x").size() < kRadiusPoints;
}

void expect_rule(const std::function<bool(double radius)>& holds_within, const PairAtRadius& pair) {
  EXPECT_TRUE(holds_within(pair.radius)) << "at the radius";
  EXPECT_TRUE(holds_within(PairAtRadius::above(pair.radius))) << "above";
  EXPECT_FALSE(holds_within(PairAtRadius::below(pair.radius))) << "below";
}

TEST_F(RadiusRule, HoldsForEveryOptionOfTheRegistryThatMeansARadius) {
  std::set<std::string> asked;
  for (const auto& [name, text] : radius_pipelines()) {
    asked.insert(name);
    for (const PairAtRadius& pair : pairs_at_radius()) {
      SCOPED_TRACE(fmt::format("{}: ({}, {}) and ({}, {}), radius {}", name, pair.p.x, pair.p.y, pair.q.x, pair.q.y,
                               pair.radius));
      expect_rule([&, &pipeline = text](double r) { return holds(made(pair, pipeline, r), r); }, pair);
    }
  }
  EXPECT_EQ(asked, radii_of_registry());
}

TEST_F(RadiusRule, HoldsForTheReferenceEngine) {
  for (const PairAtRadius& pair : pairs_at_radius())
    for (const char* text : {"knn(radius={r}) | neighborhood_size", "knn(k=2, radius_from=own) | neighborhood_size"})
      expect_rule([&](double r) { return holds(made(pair, text, r, Engine::reference), r); }, pair);
}

}  // namespace
}  // namespace pointsweep
