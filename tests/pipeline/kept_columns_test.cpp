// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pointsweep/operators/kinds/stage_operator.h"
#include "pointsweep/operators/surface/curvature.h"
#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/operators/surface/splats.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/pipeline/in_memory.h"

namespace pointsweep {
namespace {

Chain ridges(std::vector<std::string> keep) {
  return {.neighborhood = {.k = 8},
          .stages = {std::make_shared<Normals>(), std::make_shared<Curvature>(),
                     std::make_shared<Splats>(SplatsOptions{SplatAxes::curvature})},
          .keep = std::move(keep)};
}

std::vector<std::string> all_made() {
  std::vector<std::string> names;
  for (const ChainStage& stage : ridges({}).stages)
    for (const Attribute& a : contract_of(stage).makes) names.push_back(a.name);
  return names;
}

TEST(KeptColumns, ChangesNoValueOfWhatIsKept) {
  std::vector<std::vector<std::string>> keeps = {{"normal", "splat_axis", "splat_length", "splat_ratio"},
                                                 {"k1", "mean_curvature", "splat_ratio"}};
  for (const std::string& name : all_made()) keeps.push_back({name});
  for (const auto& [name, shape] : hostile_shapes()) {
    const std::vector<Vec3> points = make_cloud(shape, 700, 3);
    const RunResult whole = run_in_memory(points, ridges({}), {});
    for (const auto& keep : keeps) {
      SCOPED_TRACE(name + ", only " + keep.front());
      EngineOptions options;
      options.slab_points = 100, options.cell_points = 32, options.resources.threads = 2;
      const RunResult some = run_in_memory(points, ridges(keep), options);
      EXPECT_EQ(some.statistics.degenerate_results, whole.statistics.degenerate_results);
      for (const Field& field : some.schema.fields) {
        const auto a = some.field(field.name), b = whole.field(field.name);
        ASSERT_TRUE(std::ranges::equal(a, b, [](double x, double y) { return x == y || (x != x && y != y); }))
            << field.name;
      }
    }
  }
}

/// Returns the lifetimes of columns by attribute, for the chain `ridges`.
std::map<std::string, Lifetime> lifetimes(const std::vector<std::string>& keep) {
  Schema input;
  for (const char* axis : {"x", "y", "z"}) input.append(axis, Type::f32);
  const SweepPlan plan = plan_chain(ridges(keep), input).passes.front().plan;
  std::map<std::string, Lifetime> by_name;
  for (const Stage& stage : plan.stages) {
    const Contract contract = contract_of(stage.op);
    for (std::size_t m = 0; m < stage.makes.size(); ++m)
      by_name[contract.makes[m].name] = plan.lifetimes[stage.makes[m]];
  }
  return by_name;
}

TEST(KeptColumns, LetsAColumnLastAsLongAsAnybodyLooks) {
  auto all = lifetimes({});
  EXPECT_EQ(all["normal"], Lifetime::cell) << "read of neighbours in the second step";
  EXPECT_EQ(all["k1"], Lifetime::step) << "read by splats, and written when the last step is done";
  EXPECT_EQ(all["splat_axis"], Lifetime::step);
  auto splats = lifetimes({"splat_axis", "splat_length", "splat_ratio"});
  EXPECT_EQ(splats["normal"], Lifetime::cell);
  EXPECT_EQ(splats["k1_direction"], Lifetime::step);
  EXPECT_EQ(splats["surface_variation"], Lifetime::none);
  EXPECT_EQ(splats["splat_axis"], Lifetime::step);
  EXPECT_EQ(lifetimes({"normal"})["splat_axis"], Lifetime::none);
}

/// Makes two attributes, of which the second is not wanted. Its column needs memory nevertheless.
class TwoNumbers final : public LocalOperator {
 public:
  std::string name() const override { return "two_numbers"; }
  Contract contract() const override {
    return {{}, {}, {scalar("first", Type::f64, "1", ""), scalar("second", Type::f64, "1", "")}};
  }
  void apply(const Neighborhoods& in, Columns& out) const override {
    EXPECT_TRUE(out.wanted(0));
    EXPECT_FALSE(out.wanted(1));
    for (std::size_t i = 0; i < in.size(); ++i) {
      out.column<double>(1)[i] = 7;
      out.column<double>(0)[i] = in.position(i).x;
    }
  }
};

TEST(KeptColumns, TellsOperatorsWhichColumnsAreNotWanted) {
  const std::vector<Vec3> points = {{1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  const Chain chain{.neighborhood = {.k = 1}, .stages = {std::make_shared<TwoNumbers>()}, .keep = {"first"}};
  EXPECT_EQ(run_in_memory(points, chain, {}).field("first"), (std::vector<double>{1, 2, 3}));
}

/// Sets the value of every third row only.
class EveryThird final : public LocalOperator {
 public:
  std::string name() const override { return "every_third"; }
  Contract contract() const override { return {{}, {}, {scalar("third", Type::f32, "1", "")}}; }
  void apply(const Neighborhoods& in, Columns& out) const override {
    for (std::size_t i = 0; i < in.size(); ++i)
      if (in.row(i) % 3 == 0) out.column<float>(0)[i] = 5;
  }
};

TEST(KeptColumns, AreZeroWhereAnOperatorSaysNothing) {
  const std::vector<Vec3> points = make_cloud(hostile_shapes().front().second, 500, 3);
  EngineOptions options;
  options.slab_points = 100, options.cell_points = 32, options.resources.threads = 1;
  const Chain chain{.neighborhood = {.k = 1}, .stages = {std::make_shared<EveryThird>()}};
  const std::vector<double> third = run_in_memory(points, chain, options).field("third");
  for (std::size_t row = 0; row < third.size(); ++row) EXPECT_EQ(third[row], row % 3 == 0 ? 5 : 0) << row;
}

}  // namespace
}  // namespace pointsweep
