// SPDX-License-Identifier: MIT
/// Dropped rows: the output, and the cloud of later stages, are those of a file without these rows.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <tuple>

#include "pointsweep/error.h"
#include "pointsweep/operators.h"
#include "pointsweep/operators/kinds/box_reductions.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/pipeline/run/preview.h"
#include "tests/formats/temporary_folder.h"
#include "tests/pipeline/attribute_cloud.h"
#include "tests/pipeline/kept_rows.h"
#include "tests/pipeline/moving_clouds.h"
#include "tests/pipeline/refusal.h"
#include "tests/support/brute_force.h"
#include "tests/support/reference_engine.h"
#include "tests/support/sized.h"

namespace pointsweep {
namespace {

using Keeps = std::function<bool(const Records&, std::size_t)>;

/// Returns conditions, as texts and as functions.
const std::vector<std::pair<std::string, Keeps>>& conditions() {
  static const std::vector<std::pair<std::string, Keeps>> all = {
      {"classification == 2 || classification > 6",
       [](const Records& r, std::size_t i) {
         return r.value(i, "classification") == 2 || r.value(i, "classification") > 6;
       }},
      {"!(gain < 0.5) && intensity / 2 >= 1000.5",
       [](const Records& r, std::size_t i) {
         return !(r.value(i, "gain") < 0.5) && r.value(i, "intensity") / 2 >= 1000.5;
       }},
      {"id != 9223372036854775809 && x + y * 2 - z < 3.5",
       [](const Records& r, std::size_t i) {
         return i != 1 && r.value(i, "x") + r.value(i, "y") * 2 - r.value(i, "z") < 3.5;
       }},
      {"gain == gain", [](const Records& r, std::size_t i) { return !std::isnan(r.value(i, "gain")); }},
      {"classification in (2, 7, 9) or intensity between 100 and 2000 and not gain > 0.5",
       [](const Records& r, std::size_t i) {
         const double c = r.value(i, "classification"), n = r.value(i, "intensity");
         return c == 2 || c == 7 || c == 9 || (n >= 100 && n <= 2000 && !(r.value(i, "gain") > 0.5));
       }},
      {"gain not in (0, 1) and gain not between 0.2 and 0.4",
       [](const Records& r, std::size_t i) {
         const double gain = r.value(i, "gain");
         return gain != 0 && gain != 1 && !(gain >= 0.2 && gain <= 0.4);
       }},
      {"abs(x) in (0, 1) or min(y, z) between -0.5 and sqrt(x * x)",
       [](const Records& r, std::size_t i) {
         const double x = std::fabs(r.value(i, "x")), y = r.value(i, "y"), z = r.value(i, "z");
         const double least = std::isnan(y) || std::isnan(z) ? y + z : std::min(y, z);
         return x == 0 || x == 1 || (least >= -0.5 && least <= std::sqrt(x * x));
       }},
      {"1 < 2", [](const Records&, std::size_t) { return true; }},
  };
  return all;
}

/// Makes the value 7. Needs the diagonal of the input but no neighbours, so its pass reads rows and searches nothing.
class Stamp final : public LocalOperator {
 public:
  std::string name() const override { return "stamp"; }
  Contract contract() const override {
    return {
        .makes = {scalar("stamp", Type::f64, "1", "7")}, .values = {std::make_shared<InputDiagonal>()}, .default_k = 0};
  }
  std::shared_ptr<const LocalOperator> with_values(std::span<const std::vector<double>>) const override {
    return std::make_shared<Stamp>();
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    std::fill_n(out.column<double>(0).begin(), in.size(), 7.0);
  }
};

TEST(Rows, OfPointsWithoutAPlaceAreTreatedAsAllOthersInAPassThatSearchesNothing) {
  std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, 5000, 9);
  points[17].x = points[4321].z = std::numeric_limits<double>::quiet_NaN();
  const RunResult result = run_in_memory(points, {{}, {std::make_shared<Stamp>()}}, tiny(1000));
  EXPECT_EQ(result.statistics.sweeps, 0u);
  const std::vector<double> stamp = result.field("stamp");
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_EQ(stamp[i], 7.0) << i;
}

TEST(Where, LeavesTheCloudOfTheKeptRowsForAllLaterStages) {
  std::size_t turn = 0;
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    const Records input = with_attributes(make_cloud(shape, sized(700), 3));
    const auto& [text, keeps] = conditions()[turn++ % conditions().size()];
    const Records kept = input.those([&](std::size_t i) { return keeps(input, i); });
    if (kept.size() == 0) continue;
    expect_as_over(input, "knn(k=6) | where(" + text + ") | normals | curvature", kept,
                   "knn(k=6) | normals | curvature");
  }
}

TEST(Where, KeepsWhatThePlainLoopKeeps) {
  for (const auto& [text, keeps] : conditions()) {
    SCOPED_TRACE(text);
    const Records input = with_attributes(make_cloud(hostile_shapes()[13].second, 9001, 4));  // some rows not finite
    const Records kept = input.those([&, &k = keeps](std::size_t i) { return k(input, i); });
    const RunResult got = run_text(input, "where(" + text + ")", tiny(1000));
    EXPECT_TRUE(got.records == kept.bytes);
    EXPECT_EQ(got.statistics.sweeps, 0u);
  }
}

TEST(Where, SeesWhatEarlierStagesHaveMade) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[0].second, sized(900), 6));
  const Records made = records_of(run_text(input, "knn(k=7) | normals | neighborhood_size", tiny(200)));
  const Records kept =
      made.those([&](std::size_t i) { return made.value(i, "nz") > 0.2 && made.value(i, "neighbor_count") == 7; });
  ASSERT_GT(kept.size(), 50u);
  for (const EngineOptions& options : ways_to_run(Order::input)) {
    const RunResult got = run_text(
        input, "knn(k=7) | normals | neighborhood_size | where(nz > 0.2 && neighbor_count == 7) | curvature", options);
    const RunResult rest = run_text(kept, "knn(k=7) | curvature", tiny(100));
    EXPECT_EQ(got.field("k1"), rest.field("k1"));
    EXPECT_EQ(got.field("nx"), rest.field("nx"));
    EXPECT_EQ(got.field("id"), rest.field("id"));
  }
}

TEST(Where, AttributesThatItNeedsNeedNotBeKept) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[1].second, 500, 7));
  const Records whole = records_of(run_text(input, "normals | where(nx > 0 && classification < 5)", tiny(100)));
  const RunResult got =
      run_text(input, "normals | where(nx > 0 && classification < 5)", tiny(100), {"ny", "intensity"});
  EXPECT_EQ(got.field("ny"), run_text(input, "normals | where(nx > 0 && classification < 5)", tiny(100)).field("ny"));
  EXPECT_EQ(got.schema.fields.size(), 5u);  // x y z intensity ny
  EXPECT_EQ(got.records.size() / got.schema.stride, whole.size());
  EXPECT_TRUE(run_text(input, "where(classification < 5)", tiny(100), {"intensity"}).records.size() > 0);
}

TEST(Where, SeveralOfThemLeaveWhatAllKeep) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[4].second, 9000, 8));
  const Records kept = input.those([&](std::size_t i) {
    return input.value(i, "classification") < 7 && input.value(i, "intensity") > 9000 && input.value(i, "x") > 1;
  });
  expect_as_over(input, "knn(k=5) | where(classification < 7) | where(intensity > 9000) | where(x > 1) | normals", kept,
                 "knn(k=5) | normals");
}

TEST(Where, OfNoRowWritesNone) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[0].second, 300, 9));
  for (const Order order : {Order::input, Order::sweep}) {
    for (const char* pipeline :
         {"where(z > 1e9)", "where(z > 1e9) | normals", "normals | where(nz > 9) | normals | sor"}) {
      EngineOptions options = tiny(100, true);
      options.order = order;
      const RunResult got = run_text(input, pipeline, options);
      EXPECT_TRUE(got.records.empty());
      ASSERT_EQ(got.statistics.warnings.size(), 1u) << pipeline;
      EXPECT_NE(got.statistics.warnings[0].find("no point passed"), std::string::npos);
      EXPECT_EQ(got.statistics.points_written, 0u);
    }
  }
}

TEST(Where, SeesMovedPositionsAndEndsTheOldNeighborhoods) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, sized(600), 10);
  const Throw mover(0.5);
  std::vector<Vec3> moved;
  for (std::size_t i = 0; i < points.size(); ++i) moved.push_back(mover.moved(points[i], i));
  const Chain chain{{.k = 6}, {thrown(0.5), operators::where("z > 0"), normals()}};
  std::vector<Vec3> kept;
  for (const Vec3& p : moved)
    if (p.z > 0) kept.push_back(p);
  const RunResult expected = run_in_memory(kept, {{.k = 6}, {normals()}}, tiny(100));
  for (const EngineOptions& options : ways_to_run(Order::input)) {
    const RunResult got = run_in_memory(points, chain, options);
    for (const char* field : {"nx", "ny", "nz"}) EXPECT_EQ(got.field(field), expected.field(field));
    EXPECT_EQ(got.field("x"), expected.field("x"));
  }
}

TEST(Where, ResortOrdersThoseThatAreLeft) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[1].second, 400, 11);
  EngineOptions options = tiny(100);
  options.order = Order::sweep;
  options.axis = 2;
  const Chain chain{{.k = 6}, {thrown(0.3), operators::where("x > 0.2"), reneighbor(4), normals(), resort()}};
  const RunResult got = run_in_memory(points, chain, options);
  const std::vector<double> z = got.field("z");
  ASSERT_GT(z.size(), 100u);
  std::size_t finite = 0;
  for (const double y : got.field("y")) finite += std::isfinite(y);
  EXPECT_TRUE(std::is_sorted(z.begin(), z.begin() + static_cast<std::ptrdiff_t>(finite)));
  for (const double x : got.field("x")) EXPECT_GT(x, 0.2);
}

TEST(Where, NumbersOfRowsCountThoseThatAreLeft) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[1].second, 500, 12));
  const Records kept = input.those([&](std::size_t i) { return input.value(i, "classification") < 3; });
  const auto lists = brute_force_neighbors(kept.positions(), 4);
  for (const EngineOptions& options : ways_to_run(Order::input)) {
    InputCloud cloud = input.cloud();
    const Chain chain{{.k = 4}, {operators::where("classification < 3"), graph(4, 500)}};
    const RunResult got = run_in_memory(cloud, chain, options);
    for (std::size_t j = 0; j < 4; ++j) {
      std::vector<double> expected;
      for (const auto& list : lists) expected.push_back(list[j]);
      EXPECT_EQ(got.field(fmt::format("neighbor_{}", j)), expected);
    }
  }
}

TEST(Where, TellsWhichNameIsWrongAndWhichThereAre) {
  const Records input = with_attributes({{0, 0, 0}, {1, 1, 1}});
  const auto refused = [&](const std::string& text) { return refusal([&] { run_text(input, text, tiny(100)); }); };
  EXPECT_NE(
      refused("where(clas == 2)").find("column 1: there is no attribute 'clas'; there are x, y, z, classification"),
      std::string::npos);
  EXPECT_NE(refused("normals | where(z < 1 && normal > 0)").find("column 10: 'normal' has the components nx, ny, nz"),
            std::string::npos);
  EXPECT_NE(refused("where(nx > 0) | normals").find("no attribute 'nx'"), std::string::npos);
  EXPECT_NE(refused("where").find("'condition' is missing"), std::string::npos);
}

/// Returns which rows are the first with their coordinates, by a map.
std::vector<bool> firsts(const std::vector<Vec3>& points) {
  std::map<std::tuple<double, double, double>, std::size_t> first;
  std::vector<bool> keep;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3& p = points[i];
    keep.push_back(!is_finite(p) || first.try_emplace({p.x, p.y, p.z}, i).second);
  }
  return keep;
}

TEST(Unique, KeepsTheFirstRowOfEqualCoordinates) {
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    const std::size_t count = sized(1500);
    std::vector<Vec3> points = make_cloud(shape, count, 13);
    for (std::size_t i = 0; i < 400; ++i) points.push_back(points[7 * i % (count / 2)]);
    points.push_back({0.0, -0.0, 0.0}), points.push_back({-0.0, 0.0, 0.0}), points.push_back({0, 0, 1e-200});
    const Records input = with_attributes(points);
    const std::vector<bool> keep = firsts(points);
    const Records kept = input.those([&](std::size_t i) { return keep[i]; });
    for (const EngineOptions& options : ways_to_run(Order::input)) {
      const RunResult got = run_text(input, "unique", options);
      ASSERT_TRUE(got.records == kept.bytes);
      EXPECT_EQ(got.statistics.sweeps, 0u);
    }
    if (kept.size() > 1) expect_as_over(input, "knn(k=5) | unique | normals", kept, "knn(k=5) | normals");
  }
}

/// Moves every point to a corner of a coarse grid.
class Snap final : public LocalOperator {
 public:
  std::string name() const override { return "snap"; }
  Contract contract() const override { return {{}, {}, {position_attribute()}}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    const auto position = out.column<std::array<double, 3>>(0);
    for (std::size_t i = 0; i < in.size(); ++i) position[i] = snapped(in.position(i));
  }
  static std::array<double, 3> snapped(Vec3 p) {
    return {std::nearbyint(8 * p.x) / 8, std::nearbyint(8 * p.y) / 8, std::nearbyint(8 * p.z) / 8};
  }
};

TEST(Unique, ComparesMovedPositions) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes()[0].second, sized(800), 14);
  std::vector<Vec3> snapped;
  for (const Vec3& p : points) {
    const auto [x, y, z] = Snap::snapped(p);
    snapped.push_back({x, y, z});
  }
  const std::vector<bool> keep = firsts(snapped);
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (keep[i]) kept.push_back(snapped[i]);
  ASSERT_LT(kept.size(), points.size());
  const RunResult expected = run_in_memory(kept, {{.k = 5}, {normals()}}, tiny(100));
  for (const EngineOptions& options : ways_to_run(Order::input)) {
    const Chain chain{{.k = 5}, {std::make_shared<Snap>(), operators::unique(), normals()}};
    const RunResult got = run_in_memory(points, chain, options);
    for (const char* field : {"x", "z", "nx", "nz"}) EXPECT_EQ(got.field(field), expected.field(field));
  }
}

TEST(Select, OutliersLeaveTheCloudOfTheOthers) {
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    const Records input = with_attributes(make_cloud(shape, sized(700), 17));
    const Records marked = records_of(run_text(input, "knn(k=6) | sor(multiplier=1)", tiny(200)));
    const Records kept = marked.those([&](std::size_t i) { return marked.value(i, "outlier") == 0; });
    if (kept.size() < 2) continue;
    expect_as_over(input, "knn(k=6) | sor(multiplier=1) | where(outlier == 0) | normals", kept, "knn(k=6) | normals");
  }
}

TEST(Select, TheReferenceEngineGetsTheSameRows) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[0].second, 300, 18));
  const std::string text =
      "knn(k=300) | unique | where(classification < 8) | sor(multiplier=1) | where(outlier == 0) | normals";
  for (const Order order : {Order::input, Order::sweep}) {
    EngineOptions options = tiny(200);
    options.engine = Engine::reference;
    options.order = order;
    const RunResult got = run_text(input, text, options);
    ASSERT_EQ(got.statistics.reference->incomplete, 0u);
    options.engine = Engine::exact;
    EXPECT_TRUE(got.records == run_text(input, text, options).records);
  }
}

TEST(Select, WidthsOfFairingAreThoseOfTheRowsThatAreLeft) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[9].second, 600, 19));
  const Records kept = input.those([&](std::size_t i) { return std::abs(input.value(i, "x")) < 0.5; });
  ASSERT_LT(kept.size(), input.size());
  expect_as_over(input, "knn(k=9) | where(x < 0.5 && x > -0.5) | normals | splats | fair(f=5, g=5) | normals", kept,
                 "knn(k=9) | normals | splats | fair(f=5, g=5) | normals");
}

/// Arrays have a row for each kept point, like the arrays of a cloud of the kept points.
TEST(Select, ArraysHoldTheRowsThatAreLeft) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[0].second, 600, 21));
  const Records kept = input.those([&](std::size_t i) { return input.value(i, "classification") < 3; });
  const TemporaryFolder folder;
  const auto arrays = [&](const Records& records, const std::string& pipeline, const EngineOptions& options) {
    InputCloud cloud = records.cloud();
    EngineOptions over = options;
    over.overwrite = true;
    run(cloud, build_chain(parse_pipeline(pipeline), cloud),
        {{}, {{"normal", folder / "n.npy"}, {"splat_length", folder / "l.npy"}}, {}}, over);
    return contents(folder / "n.npy") + contents(folder / "l.npy");
  };
  for (const EngineOptions& options : ways_to_run(Order::input)) {
    const std::string got = arrays(input, "where(classification < 3) | normals | splats", options);
    EXPECT_TRUE(got == arrays(kept, "normals | splats", options));
    EXPECT_NE(got.find(fmt::format("({}, 3)", kept.size())), std::string::npos);
    const std::string late = arrays(input, "normals | splats | where(classification < 3)", options);
    EXPECT_NE(late.find(fmt::format("({}, 3)", kept.size())), std::string::npos);
    EXPECT_TRUE(late != got) << "neighbours of all points";
  }
}

TEST(Select, PassesAreAsFewAsTheChainAllows) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[0].second, 100, 15));
  const auto kinds = [&](const std::string& text) {
    InputCloud cloud = input.cloud();
    std::string letters;
    for (const PlannedPass& pass : plan_chain(build_chain(parse_pipeline(text), cloud), cloud.schema()).passes)
      letters += pass.kind == PassKind::sweep ? 's' : pass.kind == PassKind::rows ? 'r' : 'o';
    return letters;
  };
  EXPECT_EQ(kinds("normals"), "s");
  EXPECT_EQ(kinds("where(z > 0)"), "r");
  EXPECT_EQ(kinds("where(z > 0) | normals | curvature"), "rs");
  EXPECT_EQ(kinds("normals | where(nz > 0)"), "sr");
  EXPECT_EQ(kinds("sor"), "sr");
  EXPECT_EQ(kinds("normals | splats | fair | normals"), "rs");
  EXPECT_EQ(kinds("normals | splats | fair | normals | splats | fair"), "rs");
  EXPECT_EQ(kinds("where(z > 0) | normals | splats | fair | normals | splats | fair"), "rs");
  EXPECT_EQ(kinds("normals | splats | fair | reneighbor | normals | splats | fair"), "rss");
  EXPECT_EQ(kinds("normals | splats | fair | where(z > 0) | normals | splats | fair"), "rsrs");
  EXPECT_EQ(kinds("sor | normals | curvature"), "sr");
  EXPECT_EQ(kinds("sor | where(outlier == 0) | normals"), "srs");
  EXPECT_EQ(kinds("unique | sor | where(outlier == 0) | normals | where(nz > 0)"), "osrsr");
}

TEST(Select, TheDryRunNamesThePasses) {
  const Records input = with_attributes(make_cloud(hostile_shapes()[0].second, 100, 16));
  InputCloud cloud = input.cloud();
  const std::string text = to_text(
      preview(cloud, build_chain(parse_pipeline("unique | sor | where(outlier == 0) | normals"), cloud), tiny(100)));
  for (const char* words : {"pass 1 of 4", "pass 4 of 4", "mean and deviation of mean_distance", "are left out here"})
    EXPECT_NE(text.find(words), std::string::npos) << words << "\n" << text;
}

}  // namespace
}  // namespace pointsweep
