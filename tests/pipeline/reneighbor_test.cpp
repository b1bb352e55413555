// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <tuple>

#include "tests/pipeline/moving_clouds.h"
#include "tests/pipeline/whole_cloud.h"
#include "tests/support/contents.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

/// Runs the chain with different slabs, memory and threads, and compares positions, normals and the first `listed`
/// neighbours with those of WholeCloud.
void expect_as_the_whole_cloud(const std::vector<Vec3>& points, const Chain& chain, std::size_t listed = 0) {
  const WholeCloud whole(points, chain);
  std::vector<std::string> neighbors;
  for (std::size_t j = 0; j < listed; ++j) neighbors.push_back("neighbor_" + std::to_string(j));
  std::size_t finite = 0;
  for (const auto& [slab, spill, threads] :
       {std::tuple(70u, false, 1u), {150u, true, 2u}, {400u, false, 4u}, {100'000u, true, 2u}}) {
    SCOPED_TRACE(fmt::format("slabs of {}{}, {} threads", slab, spill ? ", spilled" : "", threads));
    const RunResult result = run_in_memory(points, chain, tiny(slab, spill, threads));
    ASSERT_TRUE(same_bytes(values_of<double>(result, {"x", "y", "z"}), whole.values<double>("position")));
    if (result.schema.find("nx")) {
      ASSERT_TRUE(same_bytes(values_of<float>(result, {"nx", "ny", "nz"}), whole.values<float>("normal")));
    }
    if (listed > 0) {
      ASSERT_TRUE(same_bytes(values_of<std::uint32_t>(result, neighbors), whole.values<std::uint32_t>("neighbors")));
    }
    EXPECT_EQ(result.statistics.certified + result.statistics.nonfinite, points.size());
    finite = result.statistics.certified;
  }
  EXPECT_GT(finite, points.size() / 2);
}

TEST(Reneighbor, NeighborsAreThoseOfThePositionsPointsWereThrownTo) {
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    const std::vector<Vec3> points = make_cloud(shape, 700, 21);
    for (const double reach : {0.3, 5000.0}) {
      expect_as_the_whole_cloud(points, {{.k = 8}, {thrown(reach), reneighbor(), graph(8, 700), normals()}}, 8);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(Reneighbor, MayAskForOtherNeighborhoodsAndSeveralTimes) {
  const Neighborhood near{.k = Neighborhood::kUnlimited, .radius = 0.2};
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    const Stages stages = {normals(),        thrown(0.1, 1), reneighbor(12), normals(),    thrown(4, 2),
                           Reneighbor(near), thrown(0.2, 3), reneighbor(),   graph(5, 500)};
    expect_as_the_whole_cloud(make_cloud(shape, 500, 22), {{.k = 4}, stages}, 5);
    if (HasFatalFailure()) return;
  }
}

TEST(Reneighbor, AfterFairingEqualsTheEvaluationOfTheWholeCloud) {
  for (const auto& [name, shape] : hostile_shapes()) {
    if (name == "one place") continue;  // refused: the diagonal is 0
    SCOPED_TRACE(name);
    const std::vector<Vec3> points = make_cloud(shape, 600, 23);
    expect_as_the_whole_cloud(points, chain_of("normals | splats | fair(f=9, g=9) | reneighbor | normals"));
    if (HasFatalFailure()) return;
  }
}

TEST(Reneighbor, TwiceInAChainOfFairingEqualsTheEvaluationOfTheWholeCloud) {
  const std::string fair = "normals | splats | fair(f=20, g=20) | ";
  for (const auto& [name, shape] : hostile_shapes()) {
    if (name == "one place") continue;  // refused: the diagonal is 0
    SCOPED_TRACE(name);
    const std::vector<Vec3> points = make_cloud(shape, 500, 24);
    expect_as_the_whole_cloud(points,
                              chain_of("knn(k=10) | " + fair + "reneighbor | " + fair + "reneighbor(k=6) | normals"));
    if (HasFatalFailure()) return;
  }
}

/// Returns the result of a run over the moved positions, as a file of float64 would hold them.
RunResult run_on_moved(const std::vector<Vec3>& points, const Throw& mover, const Chain& chain) {
  std::vector<Vec3> moved;
  for (const Vec3& p : points) moved.push_back(is_finite(p) ? mover.moved(p, moved.size()) : p);
  return run_in_memory(moved, chain, tiny(300));
}

TEST(Reneighbor, IsAFreshRunOverAFileOfTheMovedPositions) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, 1500, 25);
  const Throw mover(3);
  const RunResult fresh = run_on_moved(points, mover, {{.k = 9}, {normals()}});
  const Stages stages = {std::make_shared<Throw>(mover), reneighbor(9), normals()};
  EXPECT_EQ(run_in_memory(points, {{.k = 3}, stages}, tiny(100)).records, fresh.records);
}

TEST(Reneighbor, MovedPositionsAreRoundedNeitherBetweenSweepsNorInTheOutput) {
  std::vector<float> xyz(3 * 600, 1000);  // all points are in one place, and moves are far below the step of a float
  const auto cloud = cloud_of(std::make_unique<ArrayReader>(std::span<const float>(xyz)));
  const Chain chain{{.k = 6}, {thrown(1e-9), reneighbor(), graph(6, 600)}};
  const WholeCloud whole(std::vector<Vec3>(600, {1000, 1000, 1000}), chain);
  const RunResult result = run_in_memory(*cloud, chain, tiny(100));
  std::vector<std::string> names;
  for (int j = 0; j < 6; ++j) names.push_back("neighbor_" + std::to_string(j));
  EXPECT_EQ(values_of<std::uint32_t>(result, names), whole.values<std::uint32_t>("neighbors"));
  EXPECT_EQ(result.schema.fields[*result.schema.find("x")].type, Type::f64);
  EXPECT_TRUE(same_bytes(values_of<double>(result, {"x", "y", "z"}), whole.values<double>("position")));
  EngineOptions narrow = tiny(100);
  narrow.positions = Type::f32;
  const RunResult rounded = run_in_memory(*cloud, chain, narrow);
  EXPECT_EQ(rounded.schema.fields[*rounded.schema.find("x")].type, Type::f32);
  EXPECT_EQ(values_of<std::uint32_t>(rounded, names), whole.values<std::uint32_t>("neighbors"));
}

/// An operator that reads normals and an attribute that only the input has.
class Marked final : public LocalOperator {
 public:
  std::string name() const override { return "marked"; }
  Contract contract() const override {
    return {{scalar("mark", Type::f64, "", ""), normal_attribute()},
            {scalar("mark", Type::f64, "", "")},
            {scalar("sum", Type::f64, "", "marks of the neighbours and of itself, and its normal")}};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    for (std::size_t i = 0; i < in.size(); ++i) {
      const auto n = in.value<std::array<float, 3>>(1, i);
      double sum = in.value<double>(0, i) + double{n[0]} + 2 * double{n[1]} + 4 * double{n[2]};
      for (std::size_t j = 0; j < in.count(i); ++j) sum += in.neighbor_value<double>(0, i, j);
      out.column<double>(0)[i] = sum;
    }
  }
};

TEST(Reneighbor, LaterSweepsReadWhatTheFileHasAndWhatEarlierOnesMade) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[10].second, 900, 26);
  std::vector<double> xyz, marks;
  for (const Vec3& p : points) xyz.insert(xyz.end(), {p.x, p.y, p.z}), marks.push_back(double(marks.size() % 97));
  auto reader = std::make_unique<ArrayReader>(std::span<const double>(xyz));
  reader->add({"mark"}, std::span<const double>(marks));
  const auto cloud = cloud_of(std::move(reader));
  const Throw mover(2);
  const Chain chain{{.k = 7}, {normals(), std::make_shared<Throw>(mover), reneighbor(5), std::make_shared<Marked>()}};
  const RunResult result = run_in_memory(*cloud, chain, tiny(120));

  std::vector<Vec3> moved;
  for (const Vec3& p : points) moved.push_back(is_finite(p) ? mover.moved(p, moved.size()) : p);
  const auto lists = brute_force_neighbors(moved, 5);
  const WholeCloud before(points, {{.k = 7}, {normals()}});
  const std::vector<float> n = before.values<float>("normal");
  const std::vector<double> sum = result.field("sum"), mark = result.field("mark");
  for (std::size_t i = 0; i < points.size(); ++i) {
    double expected = marks[i] + double{n[3 * i]} + 2 * double{n[3 * i + 1]} + 4 * double{n[3 * i + 2]};
    for (const std::uint32_t j : lists[i]) expected += marks[j];
    ASSERT_EQ(sum[i], is_finite(moved[i]) ? expected : 0) << i;
    ASSERT_EQ(mark[i], marks[i]);
  }
  EXPECT_TRUE(same_bytes(values_of<float>(result, {"nx", "ny", "nz"}), n)) << "kept as made before the move";
}

TEST(Reneighbor, WhatSweepsCarryReachesItsRowsWhenItComesInManyPieces) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, sized(100'000), 28);
  const Chain chain{{.k = 3},
                    {normals(), thrown(0.01, 1), reneighbor(), thrown(0.01, 2), reneighbor(), graph(2, points.size())}};
  EngineOptions spilled = tiny(20'000, true, 2), whole = tiny(1'000'000, false, 2);
  const RunResult expected = run_in_memory(points, chain, whole);
  const RunResult result = run_in_memory(points, chain, spilled);
  EXPECT_EQ(result.statistics.sweeps, 3u);
  EXPECT_TRUE(result.records == expected.records);
}

TEST(Reneighbor, WritesTheAttributesInTheOrderAndLayoutOfAChainWithoutIt) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[1].second, 400, 27);
  const Stages plain = {normals(), thrown(1), graph(3, 400), normals()};
  const Stages updating = {normals(), thrown(1), reneighbor(), graph(3, 400), reneighbor(), normals()};
  EXPECT_EQ(run_in_memory(points, {{.k = 5}, updating}, tiny(100)).schema,
            run_in_memory(points, {{.k = 5}, plain}, tiny(100)).schema);
  for (const std::vector<std::string>& keep :
       {std::vector<std::string>{"normal"}, {"neighbors", "normal"}, {"position"}}) {
    const RunResult kept = run_in_memory(points, {{.k = 5}, updating, keep}, tiny(100));
    const RunResult all = run_in_memory(points, {{.k = 5}, updating}, tiny(100));
    EXPECT_EQ(kept.schema, run_in_memory(points, {{.k = 5}, plain, keep}, tiny(100)).schema);
    for (const Field& field : kept.schema.fields) {
      const auto a = kept.field(field.name), b = all.field(field.name);
      for (std::size_t i = 0; i < a.size(); ++i) ASSERT_TRUE(a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i])));
    }
  }
}

TEST(Reneighbor, ASweepWhoseResultsAreNotNeededIsLeftOut) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, 500, 28);
  const auto sweeps = [&](const Stages& stages, std::vector<std::string> keep = {}) {
    return run_in_memory(points, {{.k = 5}, stages, std::move(keep)}, tiny(100)).statistics.sweeps;
  };
  EXPECT_EQ(sweeps({normals()}), 1u);
  EXPECT_EQ(sweeps({normals(), reneighbor()}), 1u);
  EXPECT_EQ(sweeps({reneighbor(7), reneighbor(), normals()}), 1u);
  EXPECT_EQ(sweeps({thrown(1), reneighbor(7), reneighbor(), normals()}), 2u);
  EXPECT_EQ(sweeps({thrown(1), reneighbor(), normals()}, {"position"}), 1u);
  EXPECT_EQ(sweeps({thrown(1), reneighbor(), normals()}, {"normal"}), 2u);
  EXPECT_EQ(sweeps({graph(3, 500), reneighbor(), normals()}, {"normal"}), 1u);
  const RunResult last = run_in_memory(points, {{.k = 5}, {reneighbor(7), reneighbor(), normals()}}, tiny(100));
  EXPECT_EQ(last.records, run_in_memory(points, {{.k = 7}, {normals()}}, tiny(100)).records);
}

TEST(Reneighbor, TheOnlySweepLeftWritesItsResultsUnderTheirNames) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[1].second, 300, 35);
  const Chain cut{{.k = 4}, {normals(), thrown(1), reneighbor(), normals()}, {"normal"}};
  const Chain left_out{{.k = 4}, {normals(), reneighbor(5), graph(3, 300), normals()}};
  for (const Order order : {Order::input, Order::sweep}) {
    EngineOptions options = tiny(100);
    options.order = order;
    const RunResult result = run_in_memory(points, left_out, options);
    EXPECT_EQ(result.statistics.sweeps, 1u);
    EXPECT_EQ(result.schema.fields[3].name, "nx");
    const RunResult expected = run_in_memory(points, {{.k = 5}, {normals(), graph(3, 300)}}, options);
    EXPECT_EQ(result.schema, expected.schema);
    if (order == Order::input) {
      EXPECT_EQ(result.records, expected.records);
    }
    options.order = Order::input;
    EXPECT_EQ(run_in_memory(points, cut, options).statistics.sweeps, 2u);
  }
}

TEST(Reneighbor, CountsAPointCertifiedInEverySweepOnce) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[10].second, 2000, 29);
  const RunResult result = run_in_memory(
      points, {{.k = 5}, {thrown(1), reneighbor(), normals(), thrown(2, 9), reneighbor(), normals()}}, {});
  const std::vector<double> y = result.field("y");
  const auto lost =
      static_cast<std::uint64_t>(std::count_if(y.begin(), y.end(), [](double v) { return !std::isfinite(v); }));
  EXPECT_EQ(result.statistics.sweeps, 3u);
  EXPECT_GT(result.statistics.nonfinite, 80u);  // points not finite in the input, or since a move before the last sweep
  EXPECT_EQ(result.statistics.nonfinite, lost);
  EXPECT_EQ(result.statistics.certified, 2000 - lost);
  EXPECT_EQ(
      result.statistics.series.back().first, 3 * 2000 - [&] {
        std::uint64_t missing = 0;  // number of points that are not finite, summed over the three sweeps
        std::vector<Vec3> p = points;
        for (const Throw& mover : {Throw(1), Throw(2, 9)}) {
          missing +=
              static_cast<std::uint64_t>(std::count_if(p.begin(), p.end(), [](Vec3 q) { return !is_finite(q); }));
          for (std::size_t i = 0; i < p.size(); ++i) p[i] = is_finite(p[i]) ? mover.moved(p[i], i) : p[i];
        }
        return missing + lost;
      }());
  ASSERT_EQ(result.statistics.operator_seconds.size(), 4u);
  EXPECT_NE(to_json(result.statistics).find("\"sweeps\": 3"), std::string::npos);
}

TEST(Reneighbor, ArraysHoldTheKeptAttributesByInputRow) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[10].second, 700, 30);
  const Chain chain{{.k = 5}, {normals(), thrown(1), reneighbor(), graph(2, 700)}};
  std::vector<double> xyz;
  for (const Vec3& p : points) xyz.insert(xyz.end(), {p.x, p.y, p.z});
  const auto cloud = cloud_of(std::make_unique<ArrayReader>(std::span<const double>(xyz)));
  const auto path = std::filesystem::temp_directory_path() / fmt::format("updated-{}.npy", ::getpid());
  EngineOptions options = tiny(100, true);
  options.overwrite = true;
  run(*cloud, chain, {.points = {}, .arrays = {{"normal", path}}, .writer = {}}, options);
  const std::string bytes = contents(path);
  std::filesystem::remove(path);
  const std::vector<float> expected = WholeCloud(points, chain).values<float>("normal");
  ASSERT_GT(bytes.size(), expected.size() * sizeof(float));
  EXPECT_EQ(std::memcmp(bytes.data() + bytes.size() - expected.size() * sizeof(float), expected.data(),
                        expected.size() * sizeof(float)),
            0);
}

}  // namespace
}  // namespace pointsweep
