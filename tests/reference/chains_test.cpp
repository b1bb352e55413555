// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "pointsweep/operators/surface/curvature.h"
#include "pointsweep/operators/surface/fair.h"
#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/operators/surface/splats.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/run/preview.h"
#include "tests/pipeline/refusal.h"
#include "tests/reference/reference_runs.h"
#include "tests/support/brute_force.h"

namespace pointsweep {
namespace {

/// Makes "order", the number of neighbours with a smaller "order", from the "order" of the previous stage. So it
/// overwrites the attribute that it reads from neighbours.
class Smaller : public LocalOperator {
 public:
  explicit Smaller(bool first) : first_(first) {}
  std::string name() const override { return "smaller"; }
  Contract contract() const override {
    const Attribute order = scalar("order", Type::f64, "1", "");
    return first_ ? Contract{{}, {}, {order}} : Contract{{order}, {order}, {order}};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    const std::span<double> order = out.column<double>(0);
    for (std::size_t i = 0; i < in.size(); ++i) {
      order[i] = 1e3 * in.position(i).x;
      if (first_) continue;
      order[i] = 0;
      for (std::size_t j = 0; j < in.count(i); ++j)
        order[i] += in.neighbor_value<double>(0, i, j) < in.value<double>(0, i);
    }
  }

 private:
  bool first_;
};

const auto kNormals = std::make_shared<Normals>();
const auto kSplats = std::make_shared<Splats>();
const auto kFair = std::make_shared<Fair>(FairOptions{.f = 0.1, .g = 0.1});

struct NamedChain {
  std::string name;
  Stages stages;
  int hops;  ///< number of steps along neighbour lists on which a result depends
};

std::vector<NamedChain> chains() {
  return {
      {"the paper's Normal", {kNormals}, 0},
      {"the paper's Curvature",
       {kNormals, std::make_shared<Curvature>(), std::make_shared<Splats>(SplatsOptions{SplatAxes::curvature})},
       1},
      {"the paper's Fairing", {kNormals, kSplats, kFair, kNormals, kSplats}, 2},
      {"fairing twice", {kNormals, kSplats, kFair, kNormals, kSplats, kFair, kNormals}, 4},
      {"normals made again behind curvature",
       {kNormals, std::make_shared<Curvature>(),
        std::make_shared<Normals>(NormalsOptions{.orient = Orient::up, .viewpoint = {}})},
       1},
      {"fairing, then curvature of the old normals", {kNormals, kSplats, kFair, std::make_shared<Curvature>()}, 2},
      {"an operator that overwrites what it reads",
       {std::make_shared<Smaller>(true), std::make_shared<Smaller>(false), std::make_shared<Smaller>(false)},
       2},
  };
}

std::vector<Vec3> surface(std::size_t n) { return make_cloud(hostile_shapes()[0].second, n, 21); }

/// Returns the points whose neighbours up to `hops` steps away all have exact neighbourhoods.
std::vector<bool> exact_within(std::vector<bool> exact, const Lists& neighbors, int hops) {
  for (int hop = 0; hop < hops; ++hop) {
    std::vector<bool> next = exact;
    for (std::size_t i = 0; i < next.size(); ++i)
      for (const std::uint32_t j : neighbors[i]) next[i] = next[i] && exact[j];
    exact = std::move(next);
  }
  return exact;
}

TEST(ReferenceChains, GiveTheEnginesBytesWhereNeighborhoodsAreExact) {
  const std::size_t k = 10;
  const std::vector<Vec3> points = surface(3000);
  const Lists neighbors = brute_force_neighbors(points, k);
  const Lists found = neighbor_run(points, {.k = k}, k, by(Engine::reference)).lists;
  std::vector<bool> exact;
  for (std::size_t i = 0; i < points.size(); ++i) exact.push_back(found[i] == neighbors[i]);
  for (const NamedChain& chain : chains()) {
    const std::vector<bool> comparable = exact_within(exact, neighbors, chain.hops);
    for (const Order order : kOrders) {
      SCOPED_TRACE(chain.name);
      const auto records = [&](Engine engine) {
        const RunResult run = run_in_memory(points, {{.k = k}, chain.stages, {}}, by(engine, order));
        return records_by_row(run, points, order);
      };
      const std::vector<std::string> expected = records(Engine::exact), made = records(Engine::reference);
      std::size_t compared = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (!comparable[i]) continue;
        ++compared;
        ASSERT_EQ(made[i], expected[i]) << "row " << i;
      }
      EXPECT_GT(compared, points.size() / 4);
    }
  }
}

TEST(ReferenceRun, GivesTheSameRecordsAsTheEngineInEitherOrder) {
  std::vector<Vec3> points = surface(3000);
  points[17].y = std::numeric_limits<double>::quiet_NaN();
  const Chain chain{{.k = 100, .radius = 0.15}, {kNormals, kSplats, kFair, kNormals}, {}};
  for (const Order order : {Order::input, Order::sweep}) {
    const RunResult engine = run_in_memory(points, chain, by(Engine::exact, order));
    RunResult reference = run_in_memory(points, chain, by(Engine::reference, order));
    EXPECT_TRUE(engine.records == reference.records);
    ASSERT_TRUE(reference.statistics.reference);
    EXPECT_EQ(reference.statistics.reference->complete, 2999u);
    EXPECT_EQ(reference.statistics.certified, 2999u);
    EXPECT_EQ(reference.statistics.nonfinite, 1u);
    EXPECT_EQ(reference.statistics.degenerate_results, engine.statistics.degenerate_results);
    EXPECT_FALSE(engine.statistics.reference);
  }
}

TEST(ReferenceRun, TellsTheSameStatisticsAsTheEngine) {
  const Chain chain{{.k = 8}, {kNormals, std::make_shared<Curvature>()}, {}};
  const RunResult engine = run_in_memory(surface(3000), chain, by(Engine::exact));
  const RunResult reference = run_in_memory(surface(3000), chain, by(Engine::reference));
  const auto names = [](const auto& named) {
    std::vector<std::string> out;
    for (const auto& [name, value] : named) out.push_back(name);
    return out;
  };
  EXPECT_EQ(names(reference.statistics.operator_seconds), names(engine.statistics.operator_seconds));
  EXPECT_EQ(names(reference.statistics.buffers),
            (std::vector<std::string>{"read", "knn", "normals", "curvature", "write"}));
  EXPECT_EQ(names(engine.statistics.buffers), (std::vector<std::string>{"knn, normals", "curvature", "finished"}));
  ASSERT_EQ(engine.statistics.buffers[0].second.size(), engine.statistics.series.size());
  for (std::size_t i = 0; i < engine.statistics.series.size(); ++i) {
    std::uint64_t sum = 0;
    for (const auto& [name, series] : engine.statistics.buffers) sum += series[i].second;
    EXPECT_EQ(sum, engine.statistics.series[i].second) << i;
  }
}

TEST(ReferenceRun, OfSeveralSweepsGivesTheSameRecordsAsTheEngine) {
  const std::vector<Vec3> points = make_cloud(trying_shapes().back().second, 3000, 4);
  const Neighborhood wide{.k = Neighborhood::kUnlimited, .radius = 0.3};
  for (const char* text :
       {"normals | splats | fair | reneighbor | normals", "normals | splats | fair | resort | normals",
        "normals | splats | fair | resort | reneighbor(radius=0.2) | normals | curvature | splats | fair | resort"}) {
    for (const Order order : kOrders) {
      SCOPED_TRACE(text);
      Chain chain = build_chain(parse_pipeline(text), Facts{});
      chain.neighborhood = wide;
      const RunResult exact = run_in_memory(points, chain, by(Engine::exact, order));
      const RunResult reference = run_in_memory(points, chain, by(Engine::reference, order));
      EXPECT_TRUE(exact.records == reference.records);
      EXPECT_EQ(reference.statistics.sweeps, exact.statistics.sweeps);
      EXPECT_EQ(reference.statistics.reference->incomplete, 0u);
      EXPECT_EQ(reference.statistics.reference->complete, points.size() * exact.statistics.sweeps);
    }
  }
}

TEST(ReferenceRun, CannotBeResumed) {
  const std::vector<double> xyz = {0, 0, 0, 1, 0, 0};
  InputCloud cloud = cloud_of(xyz);
  EngineOptions options = by(Engine::reference);
  options.resume_folder = testing::TempDir() + "pointsweep-reference-resume";
  EXPECT_NE(refusal([&] {
              run_in_memory(cloud, {{.k = 1}, {kNormals}, {}}, options);
            }).find("cannot be resumed"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(options.resume_folder));
}

TEST(ReferenceRun, HasNoPreview) {
  const std::vector<double> xyz = {0, 0, 0, 1, 0, 0};
  InputCloud cloud = cloud_of(xyz);
  EXPECT_NE(refusal([&] {
              preview(cloud, {{.k = 1}, {kNormals}, {}}, by(Engine::reference));
            }).find("leave out --dry-run or --engine reference"),
            std::string::npos);
}

}  // namespace
}  // namespace pointsweep
