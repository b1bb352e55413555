// SPDX-License-Identifier: MIT
/// EngineOptions that decide the names and points of outputs, and the record of the run.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pointsweep/fail.h"
#include "pointsweep/operators/surface/curvature.h"
#include "pointsweep/operators/surface/normals.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/reader.h"
#include "pointsweep/writer.h"

namespace pointsweep {
namespace {

/// A rough sheet of points with an additional column; some have no finite position.
struct Sheet {
  explicit Sheet(bool with_gaps) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform;
    for (int i = 0; i < 600; ++i) {
      const bool gap = i % 7 == 3;
      const float x = uniform(random), y = uniform(random), z = 0.01f * uniform(random);
      if (gap && !with_gaps) continue;
      xyz.insert(xyz.end(), {x, gap ? std::nanf("") : y, z});
      column.push_back(5);
    }
  }
  InputCloud cloud(const char* name) const {
    auto reader = std::make_unique<ArrayReader>(std::span<const float>(xyz));
    reader->add({name}, std::span<const float>(column));
    std::vector<std::unique_ptr<Reader>> readers;
    readers.push_back(std::move(reader));
    return InputCloud(std::move(readers));
  }
  std::size_t size() const { return column.size(); }
  std::vector<float> xyz, column;
};

const Chain kCurvature{.neighborhood = {.k = 8},
                       .stages = {std::make_shared<Normals>(), std::make_shared<Curvature>()}};

/// Returns the values that a run writes in the field `name`.
std::vector<float> written(InputCloud& cloud, const EngineOptions& options, const std::string& name, std::size_t rows) {
  std::vector<float> values(rows);
  const auto writer = [&](const OutputPlan& plan) -> std::unique_ptr<Writer> {
    return std::make_unique<ArrayWriter<float>>(plan, std::vector<std::string>{name}, std::span(values));
  };
  run(cloud, kCurvature, {.points = {}, .arrays = {}, .writer = writer}, options);
  return values;
}

TEST(OutputRules, DropGivesThroughTheLibraryWhatARunOverTheOtherPointsGives) {
  const Sheet dirty(true), clean(false);
  InputCloud with = dirty.cloud("column"), without = clean.cloud("column");
  for (const Order order : {Order::input, Order::sweep}) {
    EngineOptions options;
    options.order = order;
    options.nonfinite = Nonfinite::drop;
    EXPECT_EQ(written(with, options, "k1", clean.size()), written(without, options, "k1", clean.size()));
    EXPECT_EQ(with.count(), dirty.size()) << "the cloud has all its rows again";
  }
  EngineOptions refuse;
  refuse.nonfinite = Nonfinite::refuse;
  EXPECT_THROW(written(with, refuse, "k1", dirty.size()), Error);
  EXPECT_EQ(with.count(), dirty.size());
  EXPECT_EQ(written(with, {}, "k1", dirty.size()).size(), dirty.size()) << "kept";
}

TEST(OutputRules, AnAttributeOfTheInputIsOverwrittenOnlyByItsOwnNameOrOnRequest) {
  const Sheet sheet(false);
  InputCloud cloud = sheet.cloud("curvature");
  EXPECT_THROW(written(cloud, {}, "curvature", sheet.size()), UsageError);
  EngineOptions prefix;
  prefix.prefix = "made_";
  EXPECT_EQ(written(cloud, prefix, "curvature", sheet.size()), sheet.column);
  EXPECT_NE(written(cloud, prefix, "made_surface_variation", sheet.size()), sheet.column);
  EngineOptions replace;
  replace.replace = {"curvature"};
  EXPECT_EQ(written(cloud, replace, "curvature", sheet.size()),
            written(cloud, prefix, "made_surface_variation", sheet.size()));
  InputCloud same = sheet.cloud("K1");
  EXPECT_NE(written(same, {}, "k1", sheet.size()), sheet.column);
  EXPECT_THROW(written(same, replace, "k1", sheet.size()), UsageError) << "there is no curvature to replace";
}

/// Makes an attribute under a name that other programs store as "scalar_intensity".
class Intensities final : public LocalOperator {
 public:
  std::string name() const override { return "intensities"; }
  Contract contract() const override { return {{}, {}, {scalar("intensity", Type::f32, "1", "a number")}}; }
  void apply(const Neighborhoods&, Columns&) const override {}
};

TEST(OutputRules, APrefixThatMakesANameOfTheInputIsRefused) {
  const Sheet sheet(false);
  InputCloud cloud = sheet.cloud("scalar_intensity");
  const Chain chain{.neighborhood = {.k = 8}, .stages = {std::make_shared<Intensities>()}};
  std::vector<float> values(sheet.size());
  const Outputs outputs{.points = {}, .arrays = {}, .writer = [&](const OutputPlan& plan) -> std::unique_ptr<Writer> {
                          return std::make_unique<ArrayWriter<float>>(
                              plan, std::vector<std::string>{"scalar_intensity"}, std::span(values));
                        }};
  EngineOptions prefix;
  prefix.prefix = "scalar_";
  EXPECT_THROW(run(cloud, chain, outputs, prefix), UsageError);
  prefix.replace = {"scalar_intensity"};
  run(cloud, chain, outputs, prefix);
  EXPECT_EQ(values, std::vector<float>(sheet.size(), 0)) << "replaced on request";
}

TEST(OutputRules, EqualPipelinesHaveEqualStages) {
  const auto stages = [](const std::string& text) {
    return canonical_stages(build_chain(parse_pipeline(text), Facts{}), Presets::left_out);
  };
  const std::vector<std::string> plain = {"knn(k=16)", "normals"};
  EXPECT_EQ(stages("normals"), plain);
  EXPECT_EQ(stages("knn(k=016) | normals(orient=none)"), plain);
  EXPECT_EQ(stages("knn(adaptive=none) | normals"), plain);
  EXPECT_EQ(stages("knn(radius=0.50) | normals"), (std::vector<std::string>{"knn(radius=0.5)", "normals"}));
  EXPECT_NE(stages("knn(k=8, radius=0.5) | normals"), stages("knn(radius=0.5) | normals"));
  EXPECT_EQ(stages("normals(viewpoint=[1.0,2e0,-0], orient=viewpoint)"),
            (std::vector<std::string>{"knn(k=16)", "normals(orient=viewpoint, viewpoint=[1,2,0])"}));
  for (const char* text :
       {"normals | splats | fair(f=0.3) | reneighbor(k=9) | normals | resort", "knn(k=9, k_from='a b') | normals"})
    for (const std::string& stage : stages(text))
      EXPECT_EQ(stage.starts_with("knn") ? stages(stage).front() : stages(stage).back(), stage)
          << "what is written is read as the same";
}

}  // namespace
}  // namespace pointsweep
