// SPDX-License-Identifier: MIT
/// The law of accumulators: merged accumulators of several processes equal the accumulator of one process.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "pointsweep/operators/kinds/box_reductions.h"
#include "pointsweep/operators/statistics/outliers.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/plan/chain_plan.h"
#include "tests/formats/temporary_folder.h"
#include "tests/storage/written_bytes.h"
#include "tests/support/examples.h"

namespace pointsweep {
namespace {

/// Returns the reductions of the examples of all operators and of further chains, by their texts.
std::map<std::string, std::shared_ptr<const Reduction>> all_reductions() {
  const TemporaryFolder folder;
  write_points(folder / "in.ply", cloud_for_examples(200, 1));
  write_labelled_points(folder / "other.ply", cloud_for_examples(200, 2));
  std::map<std::string, std::shared_ptr<const Reduction>> all;
  const auto add = [&](const std::shared_ptr<const Reduction>& reduction) { all[reduction->text()] = reduction; };
  add(std::make_shared<InputDiagonal>());
  add(std::make_shared<MovedBounds>());
  std::vector<std::string> pipelines = {"color(by=z)"};
  for (const std::string& name : names_of_all_operators())
    pipelines.push_back(example_of(name, (folder / "other.ply").string()).pipeline);
  for (const std::string& pipeline : pipelines) {
    InputCloud cloud({folder / "in.ply"});
    const ChainPlan plan = plan_chain(build_chain(parse_pipeline(pipeline), cloud), cloud.schema(), {});
    for (const PlannedPass& pass : plan.passes)
      for (const PlannedValue& value : pass.values) add(value.reduction);
  }
  return all;
}

std::size_t width_of(const Reduction& reduction) {
  std::size_t width = 0;
  for (const Attribute& attribute : reduction.reads()) width += attribute.fields.size();
  return width;
}

TEST(Accumulators, OfSeveralProcessesAreThatOfOne) {
  const auto reductions = all_reductions();
  EXPECT_GE(reductions.size(), 4u);
  for (const auto& [text, reduction] : reductions) {
    SCOPED_TRACE(text);
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal(1e3, 1e-3);
    const std::size_t width = width_of(*reduction), points = 1000;
    std::vector<double> values(points * width);
    for (double& value : values) value = random() % 50 == 0 ? std::numeric_limits<double>::quiet_NaN() : normal(random);
    const auto whole = reduction->start(), joined = reduction->start(), none = reduction->start();
    whole->add(values.data(), points);
    for (const auto& [first, end] :
         {std::pair(std::size_t{400}, points), std::pair(std::size_t{0}, std::size_t{400})}) {
      const auto part = reduction->start(), travelled = reduction->start();
      part->add(values.data() + first * width, end - first);
      travelled->load(part->save());
      EXPECT_EQ(hex(travelled->save()), hex(part->save()));
      joined->merge(*travelled);
    }
    joined->load(none->save());
    EXPECT_EQ(joined->finish(), whole->finish());
    EXPECT_EQ(hex(joined->save()), hex(whole->save()));
  }
}

void expect_saved(const Reduction& reduction, const std::vector<double>& values, const std::string& by_hand) {
  const auto taken = reduction.start();
  taken->add(values.data(), values.size() / width_of(reduction));
  expect_encoding(taken->save(), by_hand, [&](std::span<const std::byte> bytes) {
    const auto again = reduction.start();
    again->load(bytes);
    return again->save();
  });
}

TEST(Accumulators, SaveTheseBytes) {
  const std::string one = "0100000000000000", f1 = "000000000000f03f", f2 = "0000000000000040", f0 = "0000000000000000";
  expect_saved(MovedBounds(), {1, 2, 0, 2, 0, 0}, "0d 'box of points' 0100" + f1 + f0 + f0 + f2 + f2 + f0);
  // 1 = 16 * 2^(32 * 67 - 2148)
  const std::string sum = "43000000" + one + "1000000000000000" + "000000";
  std::size_t ends = 0;
  for (const auto& [text, reduction] : all_reductions()) {
    if (!text.starts_with("least and most of")) continue;
    expect_saved(*reduction, std::vector<double>(width_of(*reduction), 2), "0e 'ends of values' 0100" + f2 + f2);
    ++ends;
  }
  EXPECT_GT(ends, 0u);
  expect_saved(MeanAndDeviation(mean_distance_attribute()), {1}, "07 'moments' 0100" + sum + sum + one + one);
}

}  // namespace
}  // namespace pointsweep
