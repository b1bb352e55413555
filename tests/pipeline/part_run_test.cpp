// SPDX-License-Identifier: MIT
/// Runs whose tiles are tasks of their own: the bytes of one run, or a refusal before the work.
#include "pointsweep/pipeline/run/part_run.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <numeric>
#include <set>

#include "pointsweep/error.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/formats/temporary_folder.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/support/examples.h"
#include "tests/support/memory_storage.h"

namespace pointsweep {
namespace {

/// A run in parts, whose tasks and joints follow each other in one process. Each task opens its tile anew.
class RunInParts {
 public:
  RunInParts(std::vector<std::filesystem::path> inputs, std::string pipeline, std::filesystem::path folder,
             EngineOptions options)
      : inputs_(std::move(inputs)), pipeline_(std::move(pipeline)), folder_(std::move(folder)), options_(options) {}

  void perform() {
    InputCloud all(inputs_);
    const PartPlan plan = plan_parts(all, chain(all), {.tiles = outputs(inputs_)}, options_);
    options_.nonfinite = plan.nonfinite;
    std::vector<std::string> paths;
    for (const auto& path : inputs_) paths.push_back(path.string());
    std::vector<std::string> left(inputs_.size()), ordered = left;
    PartTask task;
    task.tiles = inputs_.size();
    for (std::size_t r = 0; r < plan.rounds.size(); ++r) {
      task.round = plan.rounds[r];
      const bool looks = task.round.kind == PartRoundKind::look;
      std::uint64_t dropped = 0;
      for (std::size_t t = 0; t < inputs_.size(); ++t) {
        task.tile = t;
        task.first_row = std::accumulate(plan.rows.begin(), plan.rows.begin() + std::ptrdiff_t(t), std::uint64_t{0});
        task.before = left[t];
        task.after = std::to_string(r) + "-" + std::to_string(t);
        const PartDone done = perform(task);
        dropped += done.statistics.dropped;
        points_swept_ += done.swept_points;
        if (!looks) left[t] = task.after;
      }
      if (looks) task.dropped = dropped;
      if (task.round.kind == PartRoundKind::order) join_tiles(scratch_, left, paths, task.catalogue = "tiles");
      if (!task.round.has_values) continue;
      InputCloud first({inputs_.front()});
      const std::string before = std::exchange(task.values, "values-" + std::to_string(r));
      join_values(first, chain(first), {.tiles = outputs({inputs_.front()})}, options_, task.round, scratch_, before,
                  left, task.values);
    }
  }
  std::uint64_t points_swept() const { return points_swept_; }

  Chain chain(const InputCloud& cloud) const { return build_chain(parse_pipeline(pipeline_), cloud); }
  std::vector<std::filesystem::path> outputs(const std::vector<std::filesystem::path>& inputs) const {
    std::vector<std::filesystem::path> paths;
    for (const auto& input : inputs) paths.push_back(folder_ / input.filename());
    return paths;
  }

 private:
  PartDone perform(const PartTask& task) {
    InputCloud tile({inputs_[task.tile]});
    return run_part(tile, chain(tile), {.tiles = outputs({inputs_[task.tile]})}, options_, task, scratch_);
  }

  std::vector<std::filesystem::path> inputs_;
  std::string pipeline_;
  std::filesystem::path folder_;
  EngineOptions options_;
  MemoryStorage scratch_;
  std::uint64_t points_swept_ = 0;
};

class PartRun : public testing::Test {
 protected:
  EngineOptions options() const {
    EngineOptions options;
    options.slab_points = 700;
    options.resources.threads = 2;
    options.resources.memory_bytes = 128 << 20;
    options.resources.temp_folder = folder_.path();
    return options;
  }

  /// Writes a tile for each of `tiles`, of ten-metre squares beside each other or as they come.
  void write_tiles(const std::vector<std::vector<Vec3>>& tiles, const std::string& extension = ".ply") {
    inputs_.clear();
    for (std::size_t t = 0; t < tiles.size(); ++t) {
      inputs_.push_back(folder_ / ("tile" + std::to_string(t) + extension));
      std::filesystem::remove(inputs_.back());
      write_labelled_points(inputs_.back(), tiles[t]);
    }
  }

  void run_whole(const std::string& pipeline, const EngineOptions& given) {
    InputCloud cloud(inputs_);
    Outputs outputs;
    for (const auto& input : inputs_) outputs.tiles.push_back(folder_ / "whole" / input.filename());
    EngineOptions of_run = given;
    of_run.overwrite = true;
    run(cloud, build_chain(parse_pipeline(pipeline), cloud), outputs, of_run);
  }

  void expect_same(const std::string& pipeline, const EngineOptions& given) {
    SCOPED_TRACE(pipeline);
    run_whole(pipeline, given);
    RunInParts parts(inputs_, pipeline, folder_ / "parts", given);
    ASSERT_NO_THROW(parts.perform());
    for (const auto& input : inputs_)
      EXPECT_TRUE(content_of(folder_ / "parts" / input.filename()) == content_of(folder_ / "whole" / input.filename()))
          << input;
    std::filesystem::remove_all(folder_ / "parts");
  }

  TemporaryFolder folder_;
  std::vector<std::filesystem::path> inputs_;
};

/// Divides a cloud into four squares, and a fifth tile with every twentieth point.
std::vector<std::vector<Vec3>> squares_of(const std::vector<Vec3>& cloud) {
  Box box;
  for (const Vec3& p : cloud)
    if (is_finite(p)) box.include(p);
  const Vec3 middle = box.center();
  std::vector<std::vector<Vec3>> tiles(5);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    tiles[i % 20 == 7 ? 4 : (cloud[i].x > middle.x) * 2 + (cloud[i].y > middle.y)].push_back(cloud[i]);
  return tiles;
}

class PartRunOf : public PartRun, public testing::WithParamInterface<std::string> {};

/// Operators whose points have to know more of the whole cloud than their neighbourhoods. docs/cluster.md lists them.
const std::set<std::string> kUndivided = {"components", "dbscan",   "distance_to", "ground",  "height",
                                          "level",      "m3c2",     "orient",      "poisson", "sample",
                                          "segments",   "simplify", "take",        "unique",  "voxel"};

TEST_P(PartRunOf, HasTheBytesOfOneRunOrIsRefused) {
  const std::string other = (folder_ / "other.ply").string();
  write_labelled_points(other, cloud_for_examples(500, 2));
  write_tiles(squares_of(cloud_for_examples(4000, 1)));
  const Example example = example_of(GetParam(), other);
  if (!kUndivided.contains(GetParam())) return expect_same(example.pipeline, options());
  try {
    RunInParts(inputs_, example.pipeline, folder_ / "parts", options()).perform();
    FAIL() << example.pipeline << " is not refused";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("run it in one process"), std::string::npos) << error.what();
  }
}

INSTANTIATE_TEST_SUITE_P(EveryOperator, PartRunOf, testing::ValuesIn(names_of_all_operators()),
                         [](const auto& tested) { return tested.param; });

/// Chains of two sweeps, values of the whole cloud, selects, moves, and rows of the input.
const std::vector<std::string> kChains = {
    "knn(k=6) | normals | curvature",
    "sor | where(outlier == 0) | reneighbor | normals",
    "where(row >= 300 and classification != 2) | normals | set(id = row, as=uint64)",
    "set(x = x + 3, z = 2 * z) | normals",
    "knn(k=8) | normals | curvature | splats | fair(f=0.2, g=0.2) | reneighbor | normals",
    "knn(radius=0.8) | statistics(classification_mean, count) | density",
};

class PartRunThrough : public PartRun, public testing::WithParamInterface<std::string> {};

TEST_P(PartRunThrough, HostileTilesHasTheBytesOfOneRun) {
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    std::mt19937_64 random(3);
    std::vector<Vec3> cloud(900);
    for (Vec3& p : cloud) p = shape(random);
    std::vector<std::vector<Vec3>> tiles = squares_of(cloud);
    tiles.push_back({});
    tiles.push_back({{1e4, 1e4, 0}});
    tiles.push_back({{std::numeric_limits<double>::quiet_NaN(), 0, 0}, cloud.front(), cloud.front()});
    write_tiles(tiles);
    EngineOptions spilling = options();
    spilling.spill = true;
    expect_same(GetParam(), name == "volume" ? spilling : options());
  }
}

INSTANTIATE_TEST_SUITE_P(Chains, PartRunThrough, testing::ValuesIn(kChains));

TEST_F(PartRun, DropsPointsWithoutAPlaceAsOneRunDoes) {
  std::vector<Vec3> cloud = cloud_for_examples(1000, 1);
  cloud[5].y = std::numeric_limits<double>::infinity();
  write_tiles(squares_of(cloud));
  EngineOptions dropping = options();
  dropping.nonfinite = Nonfinite::drop;
  expect_same("where(row > 3) | normals", dropping);
}

TEST_F(PartRun, IsRefusedWhereOneProcessIsNeeded) {
  write_tiles(squares_of(cloud_for_examples(400, 1)));
  InputCloud cloud(inputs_);
  const Chain normals = build_chain(parse_pipeline("normals"), cloud);
  EngineOptions sweep_order = options();
  sweep_order.order = Order::sweep;
  Outputs tiles;
  for (const auto& input : inputs_) tiles.tiles.push_back(folder_ / "parts" / input.filename());
  EXPECT_THROW(plan_parts(cloud, normals, tiles, sweep_order), UsageError);
  EXPECT_THROW(plan_parts(cloud, normals, {.points = folder_ / "one.ply"}, options()), UsageError);
}

TEST_F(PartRun, NamesTheRowOfTheTileThatAnOperatorRefuses) {
  write_tiles(squares_of(cloud_for_examples(400, 1)));
  try {
    RunInParts(inputs_, "normals | set(classification = classification + 400)", folder_ / "parts", options()).perform();
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(" of "), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("tile"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace pointsweep
