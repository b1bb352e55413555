// SPDX-License-Identifier: MIT
// Operators after a move of the points have the neighbourhoods of the search and the moved positions.
#include <fmt/format.h>

#include "pointsweep/operators.h"
#include "pointsweep/operators/statistics/neighbor_rows.h"
#include "pointsweep/operators/surface/fair.h"
#include "tests/oracles/clouds.h"
#include "tests/oracles/oracle.h"

namespace pointsweep {
namespace {

/// The operator fair, the only one of the paper that moves points, comes before other operators.
TEST(OraclesOfMovedPoints, FairedPointsGetTheNormalsOfWhereTheyAre) {
  PointCloud points(bumpy_surface(sized(4000), 7));
  for (const char* chain : {"knn(k=16) | normals | splats | fair | normals",
                            "knn(k=16) | normals | splats | fair(f=3, g=3) | normals | splats | neighborhood_size",
                            "knn(k=10) | normals | splats | fair(f=3, g=3) | normals | curvature | splats",
                            "knn(radius=0.12) | normals | splats | fair | normals | curvature",
                            "knn(k=30, adaptive=eigenentropy, k_min=6) | normals | splats | fair | normals | splats",
                            "knn(k=8) | normals | splats | fair | normals | splats | fair | normals",
                            "knn(k=12) | normals | splats | fair | features"})
    expect_formulas(points.cloud(), chain, "surface");
}

/// Rotations, a mirror, scales and inverses, also with large translations, change positions, directions and lengths of
/// earlier stages.
TEST(OraclesOfMovedPoints, AMatrixMovesTurnsAndScalesWhatWasMade) {
  PointCloud points(bumpy_surface(sized(3000), 8));
  const std::string made = "knn(k=12) | normals | curvature | splats | features | lof | density | ";
  for (const char* transform :
       {"transform([0.8,-0.6,0,500000,0.6,0.8,0,5000000,0,0,1,-3])",
        "transform([0.8,-0.6,0,5000,0.6,0.8,0,-50,0,0,1,-3], inverse=yes, scale=0.3048, translate=[1,2,3])",
        "transform([0,0,-1,0,0,1,0,0,1,0,0,0], translate=[-7,0.1,1e7])", "transform(scale=3)",
        "transform([0,2,0,0,2,0,0,0,0,0,2,1])"})
    expect_formulas(points.cloud(), made + transform, "surface");
  expect_formulas(points.cloud(), "knn(k=12) | normals | transform([1,0.5,0,3,0,1,-2,4,0.1,0,0.7,5]) | normals",
                  "sheared");
  expect_formulas(points.cloud(), "transform([1,0.5,0,3,0,1,-2,4,0.1,0,0.7,5], inverse=yes)", "sheared");
}

TEST(OraclesOfMovedPoints, RealModelsAreFaired) {
  if (real_clouds().empty()) GTEST_SKIP() << "no real clouds: set POINTSWEEP_DATA to the folder that holds them";
  for (const RealCloud& real : real_clouds()) {
    InputCloud cloud({real.file});
    expect_formulas(cloud, "knn(k=10) | normals | splats | fair | normals | splats", real.name, 0.02);
  }
}

/// A user's operator that rounds positions to a grid. Its neighbourhoods are full of ties, copies and planes.
class Snap final : public LocalOperator {
 public:
  explicit Snap(double step) : step_(step) {}
  std::string name() const override { return "snap"; }
  Contract contract() const override { return {{}, {}, {position_attribute()}}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    const auto position = out.column<std::array<double, 3>>(0);
    for (std::size_t i = 0; i < in.size(); ++i) {
      const Vec3 p = in.position(i);
      position[i] = {snapped(p.x), snapped(p.y), snapped(p.z)};
    }
  }

 private:
  double snapped(double v) const { return step_ * std::round(v / step_); }
  double step_;
};

std::vector<std::string> all_but_positions(const Chain& chain) {
  std::vector<std::string> names;
  for (const ChainStage& stage : chain.stages)
    for (const Attribute& a : contract_of(stage).makes)
      if (a.name != position_attribute().name) names.push_back(a.name);
  return names;
}

TEST(OraclesOfMovedPoints, AMoverOfTheUserIsFollowedByTheFormulas) {
  const std::vector<Vec3> surface = bumpy_surface(sized(3000), 10);
  for (const double step : {0.005, 0.05}) {
    for (const char* behind : {"knn(k=16) | normals | splats | neighborhood_size", "knn(k=12) | normals | curvature",
                               "knn(k=9) | features(with_point=no)", "knn(k=9) | features", "knn(k=9) | lof",
                               "knn(k=9) | density | ror(radius=0.08, min_neighbors=5)"}) {
      PointCloud points(surface);
      Chain chain = build_chain(parse_pipeline(behind), points.cloud());
      chain.stages.insert(chain.stages.begin(), std::make_shared<Snap>(step));
      chain.keep = all_but_positions(chain);
      expect_formulas(points.cloud(), chain, fmt::format("snapped to {}", step), 0.5);
    }
  }
}

TEST(OraclesOfMovedPoints, TheGraphBehindAMoverIsOfTheMovedPositions) {
  const std::size_t count = sized(2000);
  PointCloud points(bumpy_surface(count, 14));
  Chain chain{{.k = 9}, {std::make_shared<Snap>(0.05), std::make_shared<NeighborRows>(9, count, true)}};
  chain.keep = all_but_positions(chain);
  expect_formulas(points.cloud(), chain, "snapped", 0);
}

/// Stages after `reneighbor` have the results of a run over a file with the moved positions and the attributes made
/// before.
TEST(OraclesOfMovedPoints, NewNeighborhoodsAreThoseOfTheMovedPositions) {
  const std::string before = "knn(k=14) | normals | splats | fair(f=2, g=2)";
  for (const std::string behind : {"normals | splats | neighborhood_size", "curvature | splats | fair"}) {
    PointCloud points(bumpy_surface(sized(3000), 15));
    const auto run_of = [&](const std::string& pipeline) {
      const Chain chain = build_chain(parse_pipeline(pipeline), points.cloud());
      return run_in_memory(points.cloud(), chain, streamed(points.cloud().count()));
    };
    const RunResult whole = run_of(before + " | reneighbor(k=11) | " + behind), half = run_of(before);
    std::vector<Vec3> moved;
    const std::vector<double> x = half.field("x"), y = half.field("y"), z = half.field("z");
    for (std::size_t i = 0; i < x.size(); ++i) moved.push_back({x[i], y[i], z[i]});
    PointCloud after(moved);
    std::vector<float> normals;
    const std::vector<double> nx = half.field("nx"), ny = half.field("ny"), nz = half.field("nz");
    for (std::size_t i = 0; i < nx.size(); ++i)
      for (const double c : {nx[i], ny[i], nz[i]}) normals.push_back(static_cast<float>(c));
    after.with({"nx", "ny", "nz"}, normals);
    Chain chain = build_chain(parse_pipeline("knn(k=11) | " + behind), after.cloud());
    // The widths of fairing are those of the input's diagonal.
    for (ChainStage& stage : chain.stages)
      if (name_of(stage) == "fair")
        stage = std::get<std::shared_ptr<const LocalOperator>>(
            with_input_values(operators_of({stage}, points.cloud().schema()), points.cloud()).front());
    const OracleReport report = Oracle(after.cloud(), chain).compare(whole);
    EXPECT_EQ(report.wrong, 0u) << behind << ", of " << report.values;
    for (const std::string& difference : report.differences) ADD_FAILURE() << behind << ": " << difference;
    EXPECT_LE(report.share_open(), 0.001) << behind;
  }
}

}  // namespace
}  // namespace pointsweep
