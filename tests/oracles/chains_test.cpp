// SPDX-License-Identifier: MIT
// Every operator is compared with its formula at every point, in runs of several slabs and two threads, in memory and
// spilled.
#include "pointsweep/operators/statistics/neighbor_rows.h"
#include "pointsweep/operators/surface/fair.h"
#include "tests/oracles/clouds.h"
#include "tests/oracles/oracle.h"
#include "tests/support/brute_force.h"
#include "tests/support/reference_engine.h"

namespace pointsweep {
namespace {

TEST(Oracles, TheirGridFindsWhatBruteForceFinds) {
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, 600, 11);
    const GridNeighbors grid(points);
    for (std::uint32_t row = 0; row < points.size(); row += 7)
      for (const double radius : {0.05, std::numeric_limits<double>::infinity()})
        ASSERT_EQ(grid.of(row, 9, radius), brute_force_neighbors_of(points, row, 9, radius)) << name << ", row " << row;
  }
}

/// Chains with every operator and every attribute, each attribute as the first version that the chain makes.
const char* const kChains[] = {
    "knn(k=8) | normals | neighborhood_size",
    "knn(k=16) | normals | curvature",
    "knn(k=12) | normals | splats",
    "knn(k=5) | normals | splats(axes=positions)",
    "knn(k=24) | normals | curvature | splats(axes=curvature)",
    "knn(k=16) | normals | splats | fair",
    "knn(k=16) | normals | splats | fair(f=2, g=0.1)",
    "knn(radius=0.12) | normals | curvature | splats",
    "knn(k=9, radius=0.07) | normals | splats | neighborhood_size",
    "knn(k=70) | normals | curvature",
    "knn(k=10) | features",
    "knn(radius=0.12) | features(eigenvalues=sqrt, with_point=no)",
    "knn(k=80) | normals | features(names=[verticality,moment1_axis2,eigenentropy])",
    "knn(k=16) | features(eigenvalues=normalized)",
    "knn(k=10) | lof",
    "knn(radius=0.12) | normals | lof | density(radius=0.1)",
    "knn(k=12) | density",
    "knn(k=9) | statistics(z_median, x_mean, y_deviation, z_range, count, where=\"x > y\")",
    "knn(radius=0.12) | neighborhood_size | statistics(neighbor_count_majority, neighbor_count_max, count)",
    "knn(k=12) | normals | statistics(nz_mean, nz_median, nz_deviation, nz_range, nx_min)",
    "knn(k=4) | ror(radius=0.05, min_neighbors=4)",
    "knn(radius=0.12) | ror(radius=0.06, min_neighbors=6)"};

TEST(Oracles, EveryChainOnASurfaceIsItsFormula) {
  PointCloud points(bumpy_surface(4000));  // fewer, as under sanitizers, would leave `features` undetermined
  for (const char* chain : kChains) expect_formulas(points.cloud(), chain, "surface");
}

TEST(Oracles, TheirTolerancesAreTight) {
  PointCloud points(bumpy_surface(sized(4000), 8));
  for (const char* chain :
       {"knn(k=16) | normals | curvature", "knn(k=12) | normals | splats", "knn(k=24) | normals | curvature | splats",
        "knn(k=16) | normals | splats | fair", "knn(k=20) | features(with_point=no)"}) {
    const OracleReport report = expect_formulas(points.cloud(), chain, "surface");
    for (const auto& [name, use] : report.largest_use) {
      // Lengths are about 1, as on the surface. Curvatures come from normals that are right to 1e-7, divided by the
      // radius of the neighbourhood.
      EXPECT_LE(report.median_error(name), name == "normal" ? 2e-7 : name == "position" ? 1e-8 : 1e-5) << name;
      EXPECT_GE(use, 0.02) << name << ": the bound is " << 1 / use << " times what is ever used";
    }
  }
}

TEST(Oracles, WidthsOfFairingAreHalfAPercentOfTheDiagonal) {
  const std::vector<Vec3> surface = bumpy_surface(sized(3000), 9);
  Box box;
  for (const Vec3& p : surface) box.include(p);
  const double width = 0.005 * length(box.extent());
  PointCloud points(surface);
  const Chain usual = build_chain(parse_pipeline("knn(k=16) | normals | splats | fair"), points.cloud());
  Chain said = usual;
  said.stages.back() = std::make_shared<Fair>(FairOptions{.f = width, .g = width});
  const RunResult result = run_in_memory(points.cloud(), usual, streamed(surface.size()));
  EXPECT_EQ(Oracle(points.cloud(), said).compare(result).wrong, 0u);
  said.stages.back() = std::make_shared<Fair>(FairOptions{.f = 1.001 * width, .g = width});
  EXPECT_GT(Oracle(points.cloud(), said).compare(result).wrong, surface.size() / 2) << "a wrong width is noticed";
}

TEST(Oracles, ASpilledRunIsItsFormula) {
  PointCloud points(bumpy_surface(sized(3000), 4));
  expect_formulas(points.cloud(), "knn(k=12) | normals | curvature | splats | fair", "surface", 0.001, true);
}

TEST(Oracles, RealCloudsAreTheirFormulas) {
  if (real_clouds().empty()) GTEST_SKIP() << "no real clouds: set POINTSWEEP_DATA to the folder that holds them";
  for (const RealCloud& real : real_clouds()) {
    InputCloud cloud({real.file});
    expect_formulas(cloud, "knn(k=12) | normals | curvature | splats", real.name, 0.02);
    expect_formulas(cloud, "knn(k=12) | features", real.name, 0.02);
  }
}

TEST(Oracles, OrientationsAreWhatTheySay) {
  const std::vector<Vec3> surface = bumpy_surface(sized(3000), 5);
  PointCloud points(surface);
  expect_formulas(points.cloud(), "knn(k=10) | normals(orient=up)", "surface");
  expect_formulas(points.cloud(), "knn(k=10) | normals(orient=viewpoint, viewpoint=[0.2,-3,1.5])", "surface");
  std::vector<float> outward;
  for (const Vec3& p : surface)
    for (const double c : {p.x, p.y, p.z}) outward.push_back(static_cast<float>(c / length(p)));
  PointCloud oriented(surface);
  oriented.with({"nx", "ny", "nz"}, outward);
  expect_formulas(oriented.cloud(), "knn(k=10) | normals(orient=input)", "surface with normals");
  expect_formulas(oriented.cloud(), "knn(k=10) | curvature | splats | fair", "surface with normals");
}

TEST(Oracles, NeighborhoodsOfTheirOwnSizeAreWhatTheRulesSay) {
  const std::vector<Vec3> surface = bumpy_surface(3000, 6);  // as many points under sanitizers
  std::vector<double> k, radius;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    k.push_back(i % 40 == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(i % 30) - 2 + 0.75);
    radius.push_back(i % 50 == 0 ? -1 : 0.02 + 0.0001 * static_cast<double>(i % 900));
  }
  PointCloud points(surface);
  points.with({"wanted"}, k).with({"reach"}, radius);
  for (const char* neighborhood :
       {"knn(k=24, k_from=wanted)", "knn(k=30, radius_from=reach)", "knn(radius=0.1, radius_from=reach)",
        "knn(k=20, k_from=wanted, radius_from=reach)", "knn(k=40, adaptive=eigenentropy, k_min=5)"})
    for (const char* stages : {" | neighborhood_size | normals | curvature | splats", " | features"})
      // One or two neighbours do not determine the second axis of `features`.
      expect_formulas(points.cloud(), std::string(neighborhood) + stages, "surface", 0.03);
}

TEST(Oracles, NeighborhoodsOfTheirOwnSizeAreWhatTheRulesSayAlsoPieceByPiece) {
  const std::vector<Vec3> surface = bumpy_surface(sized(1500), 16);
  std::vector<double> k, radius;
  for (std::size_t i = 0; i < surface.size(); ++i) {
    k.push_back(static_cast<double>(i % 50));
    radius.push_back(0.03 + 0.0001 * static_cast<double>(i % 900));
  }
  PointCloud points(surface);
  points.with({"wanted"}, k).with({"reach"}, radius);
  for (const std::string neighborhood : {"k=60, radius=0.12, k_from=wanted", "radius=0.12, radius_from=reach",
                                         "k=70, radius=0.1, adaptive=eigenentropy, k_min=5"}) {
    const Chain chain = build_chain(
        parse_pipeline("knn(" + neighborhood + ") | neighborhood_size | normals | curvature"), points.cloud());
    const Oracle oracle(points.cloud(), chain);
    for (const std::uint64_t lists : {1, 2000}) {
      EngineOptions options = streamed(surface.size());
      options.lists_bytes = lists;
      options.search_again = true;
      expect_right(oracle.compare(run_in_memory(points.cloud(), chain, options)), neighborhood, 0.001);
    }
  }
}

/// If all neighbourhoods of the reference engine are exact, its values are those of the formulas.
TEST(Oracles, TheReferenceEngineMakesWhatTheFormulasSayWithinARadius) {
  PointCloud points(bumpy_surface(2000, 17));  // as many points under sanitizers
  for (const char* text :
       {"knn(radius=0.12) | normals | curvature | splats | neighborhood_size",
        "knn(radius=0.1) | normals | splats | fair",
        "knn(radius=0.12) | normals | splats | fair(f=3, g=3) | normals | splats", "knn(radius=0.12) | features",
        "knn(radius=0.12) | lof | density(radius=0.1) | ror(radius=0.05)"}) {
    const Chain chain = build_chain(parse_pipeline(text), points.cloud());
    EngineOptions options = streamed(points.cloud().count());
    options.engine = Engine::reference;
    const RunResult result = run_in_memory(points.cloud(), chain, options);
    EXPECT_EQ(result.statistics.reference->incomplete, 0u);
    expect_right(Oracle(points.cloud(), chain).compare(result), text, 0.005);
  }
}

TEST(Oracles, DegenerateCloudsGetTheDocumentedValues) {
  for (const auto& [name, shape] : hostile_shapes()) {
    PointCloud points(make_cloud(shape, sized(600), 12));
    for (const char* chain :
         {"knn(k=8) | normals | curvature", "knn(k=6) | normals | splats | neighborhood_size",
          "knn(k=20) | normals | splats | fair", "knn(k=8) | features",
          "knn(k=5) | features(with_point=no, eigenvalues=sqrt)", "knn(k=6) | lof",
          "knn(k=6) | density | ror(radius=0.03, min_neighbors=3)", "knn(radius=0.04) | density(radius=0.04)",
          "knn(k=7) | statistics(x_mean, x_deviation, y_median, y_majority, z_min, z_max, z_range, count, where=\"z < "
          "0.5\")"}) {
      if (name == "one place" && std::string(chain).find("fair") != std::string::npos) continue;  // has no diagonal
      expect_formulas(points.cloud(), chain, name, 1);
    }
  }
}

TEST(Oracles, TheGraphIsExactInRowsAndDistances) {
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::size_t count = sized(800);
    PointCloud points(make_cloud(shape, count, 13));
    for (const std::size_t k : {2, 9}) {
      const Chain chain{{.k = k}, {std::make_shared<NeighborRows>(k, count, true)}};
      expect_formulas(points.cloud(), chain, name, 0);
    }
  }
}

}  // namespace
}  // namespace pointsweep
