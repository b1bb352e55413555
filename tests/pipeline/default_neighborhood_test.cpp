// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "pointsweep/chain.h"
#include "pointsweep/operators.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/program/pipeline.h"
#include "tests/pipeline/in_memory.h"
#include "tests/pipeline/refusal.h"

namespace pointsweep {
namespace {

Chain named(const std::string& text) {
  return with_named_neighborhoods(build_chain(parse_pipeline(text), Facts{.points = 100}));
}

std::vector<Vec3> unit_sphere(std::size_t n) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::vector<Vec3> points(n);
  for (Vec3& p : points) {
    const Vec3 v{normal(random), normal(random), normal(random)};
    const double length = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
    p = {v.x / length, v.y / length, v.z / length};
  }
  return points;
}

std::vector<float> sorted_column(const RunResult& result, const char* name) {
  const std::size_t offset = result.schema.fields[*result.schema.find(name)].offset;
  std::vector<float> values(result.records.size() / result.schema.stride);
  for (std::size_t i = 0; i < values.size(); ++i)
    std::memcpy(&values[i], result.records.data() + i * result.schema.stride + offset, sizeof(float));
  std::ranges::sort(values);
  return values;
}

TEST(DefaultNeighborhood, IsTheOneThatEachOperatorOfTheRegistryDeclares) {
  for (const OperatorDeclaration& declaration : all_operators()) {
    const Chain chain{.stages = {declaration.make(sample_values(declaration), {})}};
    const Contract contract = contract_of(chain.stages.front());
    if (operator_of(chain.stages.front()) == nullptr || contract.default_k == 0) continue;
    EXPECT_GE(contract.default_k, 1u) << declaration.name;
    const Neighborhood named = with_named_neighborhoods(chain).neighborhood;
    EXPECT_EQ(named.k, contract.all_within ? Neighborhood::kUnlimited : contract.default_k) << declaration.name;
    if (contract.all_within) {
      EXPECT_EQ(named.radius, contract.all_within) << declaration.name;
    }
  }
}

TEST(DefaultNeighborhood, OfAChainIsTheLargestOfItsOperators) {
  const std::size_t normals = contract_of(operators::normals()).default_k;
  const std::size_t curvature = contract_of(operators::curvature()).default_k;
  ASSERT_LT(normals, curvature);
  EXPECT_EQ(named("normals").neighborhood.k, normals);
  EXPECT_EQ(named("normals | curvature").neighborhood.k, curvature);
  EXPECT_EQ(named("knn | normals | curvature").neighborhood.k, curvature);
  EXPECT_EQ(named("normals | reneighbor | curvature").neighborhood.k, curvature);
  EXPECT_EQ(named("normals | reneighbor(k=9) | curvature").neighborhood.k, normals);
  EXPECT_EQ(named("ror(radius=1, min_neighbors=77)").neighborhood.k, 77u);
}

TEST(DefaultNeighborhood, OfAReneighborIsThatOfTheStagesAfterIt) {
  const Neighborhood open{.k = Neighborhood::kOfOperators, .radius = 2};
  const Chain chain{.neighborhood = {.k = 5},
                    .stages = {operators::normals(), Reneighbor(open), operators::curvature(), Reneighbor(open),
                               operators::normals(), Reneighbor(Neighborhood{.k = 3}), operators::fair_in_percent()}};
  EXPECT_EQ(fmt::format("{}", fmt::join(canonical_stages(chain, Presets::left_out), " | ")),
            "knn(k=5) | normals | reneighbor(k=32, radius=2) | curvature | reneighbor(k=16, radius=2) | normals | "
            "reneighbor(k=3) | fair");
}

TEST(DefaultNeighborhood, OfNoOperatorsIsStillOpen) {
  EXPECT_EQ(canonical_stages(build_chain(parse_pipeline("knn"), Facts{}), Presets::left_out),
            std::vector<std::string>{"knn"});
}

TEST(DefaultNeighborhood, NeverReplacesOneThatIsNamed) {
  EXPECT_EQ(named("knn(k=5) | normals | curvature").neighborhood.k, 5u);
  EXPECT_EQ(named("knn(radius=2) | normals | curvature").neighborhood.k, Neighborhood::kUnlimited);
}

TEST(DefaultNeighborhood, IsAllWithinTheLargestDistanceThatOperatorsNeed) {
  for (const char* text : {"dbscan(2)", "density(radius=2)", "components(2)", "dbscan(1) | components(distance=2)",
                           "components(2) | density(1)", "where(z > 0) | dbscan(2) | where(cluster >= 0)",
                           "knn(k=5) | normals | reneighbor(radius=2) | dbscan(2)"}) {
    const std::vector<std::string> stages = canonical_stages(build_chain(parse_pipeline(text), Facts{}), {});
    const bool is_knn = std::string_view(text).find("knn") == std::string_view::npos;
    EXPECT_EQ(stages[is_knn ? 0 : 2], is_knn ? "knn(radius=2)" : "reneighbor(radius=2)") << text;
  }
}

TEST(DefaultNeighborhood, OfADistanceOfZeroHoldsThePointsAtTheSamePlace) {
  EXPECT_EQ(canonical_stages(build_chain(parse_pipeline("components(0)"), Facts{}), {}).front(), "knn(radius=0)");
  EXPECT_NE(refusal([] { named("normals | components(0)"); }).find("'components' needs all neighbours within 0"),
            std::string::npos);
}

TEST(DefaultNeighborhood, IsNoneForOperatorsThatWantDifferentOnes) {
  EXPECT_NE(refusal([] { named("normals | density(radius=2)"); })
                .find("'density' needs all neighbours within 2, and 'normals' looks at as many as the pipeline says; "
                      "write knn(radius=2) before them."),
            std::string::npos);
  EXPECT_NE(refusal([] { named("dbscan(2) | sor"); }).find("'dbscan' needs all neighbours within 2, and 'sor'"),
            std::string::npos);
}

TEST(DefaultNeighborhood, OfADistanceGivesTheBytesOfTheRadiusThatIsNamed) {
  const std::vector<Vec3> points = unit_sphere(500);
  const auto bytes = [&](const std::string& text) {
    return run_in_memory(points, build_chain(parse_pipeline(text), Facts{}), {}).records;
  };
  EXPECT_EQ(bytes("dbscan(0.2)"), bytes("knn(radius=0.2) | dbscan(0.2)"));
  EXPECT_EQ(bytes("dbscan(0.2)"), bytes("knn(radius=0.5) | dbscan(0.2)"));
  EXPECT_EQ(bytes("density(0.2)"), bytes("knn(radius=0.2) | density(0.2)"));
}

TEST(DefaultNeighborhood, GivesTheBytesOfTheNumberThatIsNamed) {
  const std::vector<Vec3> points = unit_sphere(500);
  const auto bytes = [&](const std::string& text) {
    return run_in_memory(points, build_chain(parse_pipeline(text), Facts{}), {}).records;
  };
  EXPECT_EQ(bytes("normals | curvature"), bytes("knn(k=32) | normals | curvature"));
  EXPECT_NE(bytes("normals | curvature"), bytes("knn(k=31) | normals | curvature"));
}

/// The mean curvature of a sphere of radius 1 is 1. With 8 neighbours, a tenth of the results would be below 0.66 or
/// above 1.14.
TEST(DefaultNeighborhood, ShowsTheMeanCurvatureOfASphere) {
  const RunResult result = run_in_memory(unit_sphere(10'000), named("normals | curvature"), {});
  const std::vector<float> mean = sorted_column(result, "mean_curvature");
  EXPECT_GT(mean[mean.size() / 20], 0.84f);
  EXPECT_LT(mean[mean.size() * 19 / 20], 1.1f);
}

}  // namespace
}  // namespace pointsweep
