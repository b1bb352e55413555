// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <set>

#include "pointsweep/operators.h"
#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "pointsweep/pipeline/run/preview.h"
#include "pointsweep/points/text_file.h"
#include "pointsweep/program/nearest_names.h"
#include "pointsweep/program/pipeline.h"
#include "tests/pipeline/in_memory.h"
#include "tests/pipeline/refusal.h"

namespace pointsweep {
namespace {

/// Returns a noisy paraboloid, whose normals are neither all up nor all towards one point.
std::vector<Vec3> surface() {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Vec3> points(600);
  for (Vec3& p : points) {
    p.x = uniform(random), p.y = uniform(random);
    p.z = 2 * p.x * p.x - p.y * p.y + 0.02 * uniform(random);
  }
  return points;
}

Schema schema_with_normals() {
  Schema schema;
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) schema.append(name, Type::f32);
  return schema;
}

std::vector<std::byte> records_of(const std::string& text) {
  return run_in_memory(surface(), chain_of_any_cloud(text), {}).records;
}

void expect_refused(const std::string& text, const std::string& words) {
  const std::string sentence = refusal([&] { chain_of_any_cloud(text); });
  EXPECT_NE(sentence.find(words), std::string::npos) << text << "\n" << sentence;
}

TEST(Registry, NamesAreUniqueAndCanBeWritten) {
  std::set<std::string> names = {neighborhood_declaration().name};
  for (const OperatorDeclaration& declaration : all_operators()) {
    EXPECT_TRUE(is_name(declaration.name));
    EXPECT_TRUE(names.insert(declaration.name).second) << declaration.name;
    EXPECT_FALSE(declaration.meaning.empty());
    std::set<std::string> options;
    for (const OptionDeclaration& option : declaration.options) {
      EXPECT_TRUE(is_name(option.name) && options.insert(option.name).second) << option.name;
      EXPECT_FALSE(option.meaning.empty());
    }
  }
}

TEST(Registry, EveryPresetIsAllowedAndMakesTheOperatorOfThatName) {
  for (const OperatorDeclaration& declaration : all_operators()) {
    for (const OptionDeclaration& option : declaration.options) {
      EXPECT_TRUE(!has_value(option.preset) || option.allows(option.preset)) << option.name;
      EXPECT_TRUE(!option.required || option.allows(option.sample)) << option.name;
    }
    EXPECT_EQ(name_of(declaration.make(sample_values(declaration), {})), declaration.name);
  }
}

/// Constructors check options that come from C++ and not from a parser. Neighbourhoods have no such constructor: they
/// take a rule, not numbers.
TEST(Registry, EveryOperatorRefusesNumbersOutOfTheirLimitsInTheWordsOfItsDeclaration) {
  std::size_t tried = 0;
  for (const OperatorDeclaration& declaration : all_operators())
    for (const OptionDeclaration& option : declaration.options) {
      if (declaration.name == "reneighbor") continue;
      std::vector<OptionValue> outside;
      if (option.kind == OptionKind::number)
        outside = {std::nextafter(option.least, -HUGE_VAL), std::nextafter(option.most, HUGE_VAL), -HUGE_VAL};
      if (option.kind == OptionKind::whole && option.least > 0)
        outside = {static_cast<std::uint64_t>(option.least) - 1};
      for (const OptionValue& value : outside) {
        if (option.allows(value)) continue;  // nothing lies above an infinite limit
        OptionValues values(declaration.options, declaration.name);
        for (const OptionDeclaration& other : declaration.options)
          if (other.name != option.name && other.required) values.give(other.name, other.sample);
        values.give(option.name, value);
        const std::string sentence = refusal([&] { declaration.make(values, {}); });
        EXPECT_NE(sentence.find(option.name + " is "), std::string::npos) << declaration.name << ": " << sentence;
        EXPECT_NE(sentence.find(option.allowed()), std::string::npos) << declaration.name << ": " << sentence;
        ++tried;
      }
    }
  EXPECT_GT(tried, 40u);
}

TEST(Registry, ARequiredNumberThatIsLeftOutInCppIsRefused) {
  EXPECT_NE(refusal([] { operators::decimate({}); }).find("share is a number, 0 to 1, not 'nan'"), std::string::npos);
  EXPECT_NE(refusal([] { operators::voxel({}); }).find("above 0, not '0'"), std::string::npos);
}

TEST(Registry, ATextOfSeveralNamesIsNoNameOfAFeature) {
  const std::string said = refusal([] { operators::features({.names = {"linearity,planarity"}}); });
  EXPECT_EQ(said.rfind("features: names is a list of linearity, planarity, ", 0), 0u) << said;
  EXPECT_NE(said.find("not '`linearity,planarity`'"), std::string::npos) << said;
}

/// Returns a value that the declaration allows and that is not its preset.
OptionValue another_value(const OptionDeclaration& option) {
  if (has_value(option.sample)) return option.sample;
  if (option.kind == OptionKind::choice) return option.choices.back();
  if (option.kind == OptionKind::whole) return static_cast<std::uint64_t>(option.least) + 41;
  if (option.kind == OptionKind::number) return option.least + 0.375;
  return option.kind == OptionKind::point ? OptionValue(Vec3{1, 2, 3}) : OptionValue("s t");
}

/// The polygon whose checksum is the sample of crop's option.
const char* const kPolygonOfSample = "POLYGON ((0 0, 10 0, 10 10, 0 0))";

/// A trajectory on disk, removed with the test.
class TrajectoryFile {
 public:
  TrajectoryFile() : path_(testing::TempDir() + fmt::format("pointsweep-registry-test-{}.csv", getpid())) {
    std::ofstream(path_) << text_;
  }
  ~TrajectoryFile() { std::filesystem::remove(path_); }
  TrajectoryFile(const TrajectoryFile&) = delete;
  TrajectoryFile& operator=(const TrajectoryFile&) = delete;

  const std::string& path() const { return path_; }
  std::string checksum() const { return checksum_of_text(text_); }

 private:
  std::string text_ = "0, 0, 0, 100\n10, 50, 0, 100\n";
  std::string path_;
};

/// Returns values in which `option` is not its preset, with the options that it requires.
OptionValues changed(const OperatorDeclaration& declaration, const OptionDeclaration& option,
                     const TrajectoryFile& trajectory) {
  const Option k{"k", std::uint64_t{64}};
  const std::map<std::string, Options> requires_others = {{"viewpoint", {{"orient", "viewpoint"}}},
                                                          {"k_from", {k}},
                                                          {"radius_from", {k}},
                                                          {"adaptive", {k}},
                                                          {"missing", {{"most", 5.0}}},
                                                          {"checksum", {{"polygon", kPolygonOfSample}}},
                                                          {"k_min", {k, {"adaptive", "eigenentropy"}}}};
  OptionValues values = sample_values(declaration);
  if (declaration.name == "orient") {
    if (option.name == "viewpoint") {
      values.give(option.name, another_value(option));
    } else {
      values.give("method", "trajectory");
      values.give("trajectory", trajectory.path());
      if (option.name == "checksum") values.give(option.name, trajectory.checksum());
    }
    return values;
  }
  if (!option.required) values.give(option.name, another_value(option));
  if (const auto others = requires_others.find(option.name); others != requires_others.end())
    for (const Option& other : others->second) values.give(other.name, other.value);
  return values;
}

TEST(Registry, EveryOptionOfEveryOperatorIsInItsCanonicalTextWhichIsReadBack) {
  const TrajectoryFile trajectory;
  for (const OperatorDeclaration& declaration : all_operators()) {
    for (const OptionDeclaration& option : declaration.options) {
      if (option.choices.size() == 1) continue;  // the option has only one choice
      const OptionValues values = changed(declaration, option, trajectory);
      const auto made = declaration.make(values, {});
      for (const Presets presets : {Presets::left_out, Presets::spelled_out}) {
        const std::string text = canonical_text(made, presets);
        EXPECT_NE(text.find(text_of_value(*values.find(option.name))), std::string::npos)
            << option.name << ": " << text;
        // A radius of 1e9, since some operators refuse neighbourhoods smaller than their own radius.
        EXPECT_EQ(canonical_text(chain_of_any_cloud("knn(radius=1e9) | " + text).stages.front(), presets), text);
      }
    }
  }
}

TEST(Registry, CanonicalTextsAreEqualWhereverStagesAreEqual) {
  const auto texts = [](const std::string& text, Presets presets = Presets::left_out) {
    return fmt::format("{}", fmt::join(canonical_stages(chain_of_any_cloud(text), presets), " | "));
  };
  EXPECT_EQ(texts("normals"), "knn(k=16) | normals");
  EXPECT_EQ(texts("knn(k=08) | normals(orient=none)"), "knn(k=8) | normals");
  EXPECT_EQ(texts("normals", Presets::spelled_out), "knn(k=16) | normals(orient=none)");
  EXPECT_EQ(texts("knn(radius=5e-1) | normals(viewpoint=[0.0,-0,1.70], orient=viewpoint)"),
            "knn(radius=0.5) | normals(orient=viewpoint, viewpoint=[0,0,1.7])");
  EXPECT_EQ(texts("knn(k=40, k_min=10, adaptive=eigenentropy) | fair(g=0.50, f=3)"),
            "knn(k=40, adaptive=eigenentropy) | fair(f=3)");
  EXPECT_EQ(texts("normals | reneighbor(adaptive=none) | normals"), "knn(k=16) | normals | reneighbor(k=16) | normals");
  EXPECT_EQ(texts("normals | reneighbor(k=30, k_min=10, adaptive=eigenentropy)"),
            texts("normals | reneighbor(adaptive=eigenentropy, k=30)"));
  EXPECT_EQ(texts(R"([{"type": "knn", "k": 12, "k_from": "a b"}, {"type": "fair", "f": 0.25}])"),
            "knn(k=12, k_from=\"a b\") | fair(f=0.25)");
  for (const char* text : {"normals | splats(axes=positions) | fair(f=2)", "knn(k=9, radius=0.1) | neighborhood_size",
                           "knn(k=50, adaptive=eigenentropy, k_min=12) | normals(orient=up)"})
    for (const Presets presets : {Presets::left_out, Presets::spelled_out})
      EXPECT_EQ(texts(texts(text, presets), presets), texts(text, presets));
}

TEST(Registry, APresetSpelledOutChangesNothing) {
  EXPECT_EQ(records_of("normals"), records_of("knn | normals"));
  EXPECT_EQ(records_of("normals"), records_of("knn(k=16) | normals(orient=none)"));
}

TEST(Registry, EveryOptionOfKnnChangesTheOutput) {
  const auto plain = records_of("normals");
  EXPECT_NE(records_of("knn(k=12) | normals"), plain);
  EXPECT_NE(records_of("knn(radius=0.2) | normals"), plain);
  EXPECT_NE(records_of("knn(k=8, radius=0.05) | normals"), plain);
  EXPECT_NE(records_of("knn(k=8, radius=0.2) | normals"), records_of("knn(radius=0.2) | normals"));
  EXPECT_NE(records_of("knn(k=8, k_from=z) | normals"), plain);
  EXPECT_NE(records_of("knn(k=8, radius_from=x) | normals"), plain);
  const auto adaptive = records_of("knn(k=30, adaptive=eigenentropy) | normals");
  EXPECT_NE(adaptive, records_of("knn(k=30) | normals"));
  EXPECT_EQ(adaptive, records_of("knn(k=30, adaptive=eigenentropy, k_min=10) | normals"));
  EXPECT_NE(adaptive, records_of("knn(k=30, adaptive=eigenentropy, k_min=20) | normals"));
  EXPECT_EQ(plain, records_of("knn(adaptive=none) | normals"));
}

TEST(Registry, RulesOfNeighborhoodsNeedAMostAndDoNotMix) {
  expect_refused("knn(k_from=s) | normals",
                 "column 1: knn: k_from needs k, the most that any point may have, as in knn(k=64, k_from=s)");
  expect_refused("knn(radius=1, k_from=s) | normals", "k_from needs k");
  expect_refused("knn(radius_from=s) | normals", "radius_from needs k or radius");
  expect_refused("knn(adaptive=eigenentropy) | normals", "adaptive needs k");
  expect_refused("knn(k=9, adaptive=eigenentropy) | normals", "k_min is 10, but k, the most there may be, is 9");
  expect_refused("knn(k=9, k_min=4) | normals", "k_min is used only with adaptive=eigenentropy");
  expect_refused("knn(k=20, adaptive=eigenentropy, k_from=s) | normals", "adaptive chooses k itself");
  expect_refused("knn(k=20, adaptive=entropy) | normals", "adaptive is none or eigenentropy, not 'entropy'");
  expect_refused("knn(k=20, adaptive=eigenentropy, k_min=2) | normals", "k_min is a whole number, 3 or more");
  expect_refused("knn(k=20, k_from='') | normals", "k_from is the name of an attribute, not ''");
}

TEST(Registry, EveryOptionOfNormalsChangesTheOutput) {
  const auto plain = records_of("normals");
  const auto up = records_of("normals(orient=up)"), seen = records_of("normals(orient=viewpoint, viewpoint=[0,0,-9])");
  EXPECT_NE(up, plain);
  EXPECT_NE(seen, plain);
  EXPECT_NE(seen, up);
  EXPECT_NE(records_of("normals(orient=viewpoint, viewpoint=[0,9,0])"), seen);
  EXPECT_NE(records_of("normals(orient=up) | normals(orient=input)"), plain);
}

TEST(Registry, EveryOptionOfSplatsChangesTheOutput) {
  const std::string before = "knn(k=16) | normals | curvature | ";
  EXPECT_NE(records_of(before + "splats(axes=positions)"), records_of(before + "splats(axes=curvature)"));
  EXPECT_EQ(records_of(before + "splats"), records_of(before + "splats(axes=curvature)"));
  EXPECT_EQ(records_of("normals | splats"), records_of("normals | splats(axes=positions)"));
}

TEST(Registry, EveryOptionOfFairChangesTheOutput) {
  const std::string before = "knn(k=16) | normals | splats | ";
  const auto plain = records_of(before + "fair");
  EXPECT_EQ(records_of(before + "fair(f=0.5, g=0.5)"), plain);
  EXPECT_NE(records_of(before + "fair(f=9)"), plain);
  EXPECT_NE(records_of(before + "fair(f=9, g=5)"), records_of(before + "fair(f=9)"));
  expect_refused(before + "fair(f=0)", "f is a number, 1e-06 to 100, not '0'");
}

TEST(Registry, EveryOptionOfReneighborChangesTheOutput) {
  const std::string before = "knn(k=16) | normals | splats | fair(f=9, g=5) | ", after = " | normals";
  const auto plain = records_of(before + "reneighbor" + after);
  EXPECT_NE(plain, records_of("knn(k=16) | normals | splats | fair(f=9, g=5) | normals"));
  EXPECT_EQ(records_of(before + "reneighbor(k=16)" + after), plain);
  EXPECT_NE(records_of(before + "reneighbor(k=12)" + after), plain);
  EXPECT_NE(records_of(before + "reneighbor(radius=0.2)" + after), plain);
  EXPECT_NE(records_of(before + "reneighbor(k=8, radius=0.1)" + after), records_of(before + "reneighbor(k=8)" + after));
  EXPECT_NE(records_of(before + "reneighbor(k=8, radius=0.2)" + after),
            records_of(before + "reneighbor(radius=0.2)" + after));
}

TEST(Registry, WidthsOfFairFollowTheDiagonal) {
  const auto stages = parse_pipeline("knn(k=16) | normals | splats | fair(f=2, g=2)");
  const auto scaled = [&](double scale) {
    std::vector<double> xyz;
    for (const Vec3& p : surface()) xyz.insert(xyz.end(), {scale * p.x, scale * p.y, scale * p.z});
    std::vector<std::unique_ptr<Reader>> readers;
    readers.push_back(std::make_unique<ArrayReader>(std::span<const double>(xyz)));
    InputCloud cloud(std::move(readers));
    return run_in_memory(cloud, build_chain(stages, cloud), {}).field("z");
  };
  const auto z = scaled(1), large = scaled(1024);
  double moved = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    EXPECT_NEAR(large[i] / 1024, z[i], 1e-9);
    moved += std::abs(z[i] - surface()[i].z);
  }
  EXPECT_GT(moved, 0.01);
}

TEST(Registry, FairRefusesACloudInOnePlace) {
  const Chain chain = chain_of_any_cloud("normals | splats | fair");
  const std::vector<Vec3> points(9, {1, 2, 3});
  EXPECT_NE(refusal([&] { run_in_memory(points, chain, {}); }).find("column 20: fair: all points lie in one place"),
            std::string::npos);
}

TEST(Registry, PipelinesAreTheChainsOneWouldBuildByHand) {
  const Chain by_hand{{.k = 12}, {std::make_shared<Normals>(NormalsOptions{.orient = Orient::up, .viewpoint = {}})}};
  EXPECT_EQ(records_of("knn(k=12) | normals(orient=up)"), run_in_memory(surface(), by_hand, {}).records);
}

TEST(Registry, UnknownNamesGetTheNearestKnownOnes) {
  expect_refused("normal", "column 1: no operator is called 'normal'; the nearest is 'normals'");
  expect_refused("knn | nrmals(orient=up)", "column 7: no operator is called 'nrmals'");
  expect_refused("normals(orientation=up)",
                 "column 9: normals has no option 'orientation'; the nearest it has are 'orient'");
  expect_refused("knn(n=8) | normals", "knn has no option 'n'");
  expect_refused(R"([{"type": "knn"}, {"type": "normal"}])", "pipeline, stage 2: no operator");
}

TEST(Registry, ValuesOutOfRangeAreRefusedWithTheRange) {
  expect_refused("knn(k=0) | normals", "column 5: knn: k is a whole number, 1 or more, not '0'");
  expect_refused("knn(k=-3)", "not '-3'");
  expect_refused("knn(k=2.5)", "not '2.5'");
  expect_refused("knn(k=99999999999999999999)", "k is a whole number");
  expect_refused("knn(radius=-1)", "radius is a number, 0 or more, not '-1'");
  expect_refused("knn(radius=nan)", "not 'nan'");
  expect_refused("knn(radius=inf)", "not 'inf'");
  expect_refused("normals(orient=sideways)", "orient is none, up, viewpoint or input, not 'sideways'");
  expect_refused("normals(orient=viewpoint, viewpoint=[1,2])", "viewpoint is three numbers [X,Y,Z], not '1,2'");
  expect_refused("normals(orient=viewpoint, viewpoint=[1,2,3,4])", "not '1,2,3,4'");
  expect_refused("normals(orient=viewpoint, viewpoint=[1,2,inf])", "not '1,2,inf'");
}

TEST(Registry, OptionsThatWouldDoNothingAreRefused) {
  expect_refused("normals(viewpoint=[0,0,1])", "viewpoint is used only with orient=viewpoint");
  expect_refused("normals(orient=up, viewpoint=[0,0,1])", "viewpoint is used only with orient=viewpoint");
  expect_refused("normals(orient=viewpoint)", "needs the point");
  expect_refused("knn(k=8, k=9)", "column 10: knn: 'k' is given twice");
}

TEST(Registry, KnnComesOnceAndFirst) {
  expect_refused("normals | knn(k=8)", "column 11: knn comes once and first");
  expect_refused("knn | knn | normals", "column 7: knn comes once and first");
}

TEST(Registry, NearestNamesAreOrderedByEdits) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("abc", "abc"), 0u);
  EXPECT_EQ(nearest_names("bat", {"dog", "cats", "bat", "cat"}), "'bat', 'cat' or 'cats'");
  EXPECT_EQ(nearest_names("x", {"only"}), "'only'");
}

TEST(Registry, AProbableNameDiffersInAThirdOfItsLettersAtMostOrIsBegun) {
  const std::vector<std::string> verbs = {"normals", "neighbors", "run", "fair"};
  EXPECT_EQ(probable_name("norml", verbs), "normals");
  EXPECT_EQ(probable_name("NORMALS", verbs), "normals");
  EXPECT_EQ(probable_name("neig", verbs), "neighbors");
  EXPECT_EQ(probable_name("rnu", verbs), std::nullopt);
  EXPECT_EQ(probable_name("ne", verbs), std::nullopt);
  EXPECT_EQ(probable_name("triangulate", verbs), std::nullopt);
  EXPECT_EQ(probable_name("", verbs), std::nullopt);
  EXPECT_EQ(probable_name("a", {"b"}), std::nullopt) << "no letter would be the same";
}

TEST(Keep, WritesOnlyWhatItNames) {
  Chain chain = chain_of_any_cloud("normals");
  const RunResult all = run_in_memory(surface(), chain, {});
  chain.keep = {"normal"};
  EXPECT_EQ(run_in_memory(surface(), chain, {}).records, all.records);
  EXPECT_EQ(plan_chain(chain, schema_with_normals()).passes.front().plan.result_bytes, 12u);
}

/// Makes two attributes with different values: 1 and 2.
class Pair final : public LocalOperator {
 public:
  std::string name() const override { return "pair"; }
  Contract contract() const override {
    return {{}, {}, {scalar("left", Type::f32, "1", "1"), scalar("right", Type::f64, "1", "2")}};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    for (std::size_t i = 0; i < in.size(); ++i) out.column<float>(0)[i] = 1, out.column<double>(1)[i] = 2;
  }
};

TEST(Keep, TheOthersAreMadeForLaterStagesAndThenDropped) {
  Chain chain{{}, {std::make_shared<Normals>(), std::make_shared<Pair>()}};
  for (const Order order : {Order::input, Order::sweep}) {
    EngineOptions options;
    options.order = order;
    chain.keep = {"right"};
    const RunResult right = run_in_memory(surface(), chain, options);
    EXPECT_FALSE(right.schema.find("nx") || right.schema.find("left"));
    for (const double value : right.field("right")) ASSERT_EQ(value, 2);
    chain.keep = {"left", "normal"};
    const RunResult left = run_in_memory(surface(), chain, options);
    EXPECT_TRUE(left.schema.find("nx") && left.schema.find("left") && !left.schema.find("right"));
    for (const double value : left.field("left")) ASSERT_EQ(value, 1);
  }
}

TEST(Keep, UnknownNamesAreRefusedWithWhatIsMade) {
  Chain chain{{}, {std::make_shared<Normals>(), std::make_shared<Pair>()}};
  chain.keep = {"left", "centre"};
  const std::string sentence = refusal([&] { plan_chain(chain, schema_with_normals()); });
  EXPECT_EQ(sentence,
            "'centre' cannot be kept; the input has x, y, z, nx, ny, nz, and what is made is normal, left, right.");
}

/// An operator that reads the normals of neighbours.
class Across final : public LocalOperator {
 public:
  std::string name() const override { return "across"; }
  Contract contract() const override {
    return {{scalar("left", Type::f32, "1", "1")}, {normal_attribute()}, {scalar("sum", Type::f32, "1", "")}};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    for (std::size_t i = 0; i < in.size(); ++i) out.column<float>(0)[i] = 0;
  }
};

class PreviewOfAChain : public testing::Test {
 protected:
  PreviewOfAChain() {
    for (const Vec3& p : surface()) xyz_.insert(xyz_.end(), {p.x, p.y, p.z});
    std::vector<std::unique_ptr<Reader>> readers;
    readers.push_back(std::make_unique<ArrayReader>(std::span<const double>(xyz_)));
    cloud_.emplace(std::move(readers));
  }
  std::vector<double> xyz_;
  std::optional<InputCloud> cloud_;
  Chain chain_{
      {},
      {std::make_shared<Pair>(), std::make_shared<Normals>(), std::make_shared<Across>(), std::make_shared<Normals>()}};
};

TEST_F(PreviewOfAChain, SaysWhenColumnsDie) {
  chain_.keep = {"sum"};
  const Preview p = preview(*cloud_, chain_);
  ASSERT_EQ(p.planned.passes.size(), 1u);
  const std::vector<ColumnPlan>& columns = p.planned.passes[0].columns;
  ASSERT_EQ(columns.size(), 5u);
  const auto expect = [&](std::size_t c, const char* name, const char* made_by, std::size_t last_step, bool written) {
    EXPECT_EQ(columns[c].attribute, name);
    EXPECT_EQ(columns[c].made_by, made_by);
    EXPECT_EQ(columns[c].last_step, last_step) << name;
    EXPECT_EQ(columns[c].written, written) << name;
  };
  expect(0, "left", "1 pair", 1, false);
  expect(1, "right", "1 pair", 0, false);
  expect(2, "normal", "2 normals", 1, false);
  expect(3, "sum", "3 across", 1, true);
  expect(4, "normal", "4 normals", 1, false);
  EXPECT_EQ(p.planned.passes[0].plan.result_bytes, 4u);
}

TEST_F(PreviewOfAChain, NamesTheBufferOfEveryStage) {
  const std::string text = to_text(preview(*cloud_, chain_));
  const auto line = [&](const std::string& start) {
    const auto at = text.find("  " + start + " ");
    return at == text.npos ? "" : text.substr(at, text.find('\n', at) - at);
  };
  EXPECT_NE(line("1 pair").find(" 1  through"), std::string::npos) << text;
  EXPECT_NE(line("2 normals").find(" 1  through"), std::string::npos) << text;
  EXPECT_NE(line("3 across").find(" 2  pre-buffer"), std::string::npos) << text;
  EXPECT_NE(line("4 normals").find(" 2  through"), std::string::npos) << text;
  EXPECT_NE(text.find("28 bytes a point"), std::string::npos) << text;
}

TEST_F(PreviewOfAChain, RefusesWhatARunWouldRefuse) {
  EngineOptions options;
  options.resources.memory_bytes = 1 << 20;
  EXPECT_THROW(preview(*cloud_, chain_, options), Error);
  chain_.stages.erase(chain_.stages.begin());
  EXPECT_THROW(preview(*cloud_, chain_), UsageError);
}

TEST_F(PreviewOfAChain, ChainsAreCheckedAgainstTheCloud) {
  const auto refused = [&](const std::string& text, const std::vector<std::string>& keep = {}) {
    return refusal([&] { plan_chain(build_chain(parse_pipeline(text), *cloud_, keep), cloud_->schema()); });
  };
  EXPECT_EQ(refused("knn(k=3)"), "") << "which copies; the tool and Python ask for an operator";
  EXPECT_NE(refusal([&] { require_operators(build_chain(parse_pipeline("knn(k=3)"), Facts{})); }), "");
  EXPECT_NE(refused("normals(orient=input)").find("needs 'normal'"), std::string::npos);
  EXPECT_NE(refused("normals", {"colour"}).find("'colour'"), std::string::npos);
  EXPECT_EQ(build_chain(parse_pipeline("normals"), *cloud_, {"normal"}).keep, std::vector<std::string>{"normal"});
}

}  // namespace
}  // namespace pointsweep
