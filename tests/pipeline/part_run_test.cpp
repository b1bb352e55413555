// SPDX-License-Identifier: MIT
/// Runs in which each tile is a task of its own give the bytes of one run, or are refused before the work.
#include "pointsweep/pipeline/run/part_run.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>

#include "pointsweep/cloud.h"
#include "pointsweep/error.h"
#include "pointsweep/in_order_operator.h"
#include "pointsweep/math/mix.h"
#include "pointsweep/operators/thinning/undecided_points.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/formats/temporary_folder.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/support/examples.h"
#include "tests/support/memory_storage.h"

namespace pointsweep {
namespace {

/// A run in parts, whose tasks and joins are performed one after another in one process. Each task opens its tile
/// again.
class RunInParts {
 public:
  RunInParts(std::vector<std::filesystem::path> inputs, std::string pipeline, std::filesystem::path folder,
             EngineOptions options)
      : inputs_(std::move(inputs)), pipeline_(std::move(pipeline)), folder_(std::move(folder)), options_(options) {}

  void perform() {
    InputCloud all(inputs_);
    facts_ = facts_of(all);
    const PartPlan plan = plan_parts({all, chain(), {.tiles = outputs(inputs_)}, options_});
    options_.nonfinite = plan.nonfinite;
    std::vector<std::string> paths;
    for (const auto& path : inputs_) paths.push_back(path.string());
    std::vector<std::string> left(inputs_.size()), ordered = left;
    PartTask task;
    task.tiles = inputs_.size();
    task.record = plan.record;
    for (std::size_t r = 0; r < plan.rounds.size(); ++r) {
      task.round = plan.rounds[r];
      if (task.round.kind() == PartRoundKind::other) {
        store_others(plan, task, r);
        continue;
      }
      const bool looks = task.round.kind() == PartRoundKind::look;
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
      if (task.round.join == PartJoin::tiles) join_tiles(scratch_, left, paths, task.catalogue = "tiles");
      InputCloud first({inputs_.front()});
      const bool borders = task.round.join == PartJoin::borders;
      if (borders || task.round.join == PartJoin::components) {
        std::string& key = borders ? task.borders : task.components;
        key = "joined-" + std::to_string(r);
        join_graph({first, chain(), {.tiles = outputs({inputs_.front()})}, options_}, task.round, scratch_,
                   {task.catalogue, task.borders}, left, key);
      }
      if (task.round.join != PartJoin::values) continue;
      const std::string before = std::exchange(task.values, "values-" + std::to_string(r));
      join_values({first, chain(), {.tiles = outputs({inputs_.front()})}, options_}, task.round, scratch_, before, left,
                  task.values);
    }
  }
  std::uint64_t points_swept() const { return points_swept_; }

  /// Returns the chain with the facts of the whole cloud, for a task of any tile.
  Chain chain() const { return build_chain(parse_pipeline(pipeline_), facts_); }
  std::vector<std::filesystem::path> outputs(const std::vector<std::filesystem::path>& inputs) const {
    std::vector<std::filesystem::path> paths;
    for (const auto& input : inputs) paths.push_back(folder_ / input.filename());
    return paths;
  }

 private:
  void store_others(const PartPlan& plan, PartTask& task, std::size_t round) {
    const auto files = std::ranges::find(plan.others, task.round.pass(), &OtherFiles::pass);
    ASSERT_NE(files, plan.others.end());
    std::vector<std::string> stored;
    for (std::size_t f = 0; f < files->paths.size(); ++f) {
      task.other_file = files->paths[f];
      task.tile = 0;
      task.after = "other" + std::to_string(round) + "-" + std::to_string(f);
      EXPECT_EQ(perform(task).rows, files->counts[f]);
      stored.push_back(task.after);
    }
    join_tiles(scratch_, stored, files->paths, task.other_catalogue = "others" + std::to_string(round));
  }
  PartDone perform(const PartTask& task) {
    InputCloud tile({inputs_[task.tile]});
    return run_part({tile, chain(), {.tiles = outputs({inputs_[task.tile]})}, options_}, task, scratch_);
  }

  std::vector<std::filesystem::path> inputs_;
  std::string pipeline_;
  std::filesystem::path folder_;
  EngineOptions options_;
  Facts facts_;
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

  /// Writes a file for each of `tiles`.
  void write_tiles(const std::vector<std::vector<Vec3>>& tiles, const std::string& extension = ".ply") {
    inputs_.clear();
    for (std::size_t t = 0; t < tiles.size(); ++t) {
      inputs_.push_back(folder_ / ("tile" + std::to_string(t) + extension));
      std::filesystem::remove(inputs_.back());
      write_labelled_points(inputs_.back(), tiles[t]);
    }
  }

  /// Writes the folder of files that replaces the name OTHER in pipelines.
  void write_other(const std::vector<std::vector<Vec3>>& files) const {
    std::filesystem::create_directories(folder_ / "other");
    for (std::size_t f = 0; f < files.size(); ++f) {
      const std::filesystem::path path = folder_ / "other" / (std::to_string(f) + ".ply");
      std::filesystem::remove(path);
      write_labelled_points(path, files[f]);
    }
  }
  std::string with_other(std::string pipeline) const {
    const std::string name = "OTHER";
    for (std::size_t at = 0; (at = pipeline.find(name)) != std::string::npos;)
      pipeline.replace(at, name.size(), (folder_ / "other").string());
    return pipeline;
  }

  void run_whole(const std::string& pipeline, const EngineOptions& given) {
    InputCloud cloud(inputs_);
    Outputs outputs;
    for (const auto& input : inputs_) outputs.tiles.push_back(folder_ / "whole" / input.filename());
    EngineOptions of_run = given;
    of_run.overwrite = true;
    run(cloud, build_chain(parse_pipeline(pipeline), cloud), outputs, of_run);
  }

  /// Expects that a run in parts has the bytes of a whole run. Returns the number of points that the sweeps of the
  /// parts took.
  std::uint64_t expect_same(const std::string& pipeline, const EngineOptions& given) {
    SCOPED_TRACE(pipeline);
    run_whole(pipeline, given);
    RunInParts parts(inputs_, pipeline, folder_ / "parts", given);
    EXPECT_NO_THROW(parts.perform());
    for (const auto& input : inputs_)
      EXPECT_TRUE(contents(folder_ / "parts" / input.filename()) == contents(folder_ / "whole" / input.filename()))
          << input;
    std::filesystem::remove_all(folder_ / "parts");
    return parts.points_swept();
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

/// Returns whether a stage of the pipeline may look at all points of the cloud.
bool looks_at_all(const std::string& pipeline, const std::filesystem::path& input) {
  return std::ranges::any_of(parse_chain(pipeline, Cloud({input})).stages, [](const ChainStage& stage) {
    const auto* in_order = std::get_if<std::shared_ptr<const InOrderOperator>>(&stage);
    return in_order != nullptr && !(*in_order)->reach();
  });
}

TEST_F(PartRun, DividesEveryOperatorButThoseThatTheDocumentNames) {
  const std::string other = (folder_ / "other.ply").string();
  write_labelled_points(other, cloud_for_examples(500, 2));
  write_tiles(squares_of(cloud_for_examples(4000, 1)));
  std::string refused;
  for (const std::string& name : names_of_all_operators())
    if (looks_at_all(example_of(name, other).pipeline, inputs_.front()))
      refused += fmt::format("{}`{}`", refused.empty() ? "" : " and ", name);
  std::ifstream file(POINTSWEEP_SOURCE_DIR "/docs/cluster.md");
  const std::string document((std::istreambuf_iterator<char>(file)), {});
  EXPECT_NE(document.find("\nEvery operator but " + refused + ", operators of your own"), std::string::npos) << refused;
  EXPECT_NE(document.find("\n" + refused + " are refused before the work"), std::string::npos) << refused;
}

TEST_P(PartRunOf, HasTheBytesOfOneRunOrIsRefused) {
  const std::string other = (folder_ / "other.ply").string();
  write_labelled_points(other, cloud_for_examples(500, 2));
  write_tiles(squares_of(cloud_for_examples(4000, 1)));
  const Example example = example_of(GetParam(), other);
  if (!looks_at_all(example.pipeline, inputs_.front())) return (void)expect_same(example.pipeline, options());
  try {
    RunInParts(inputs_, example.pipeline, folder_ / "parts", options()).perform();
    FAIL() << example.pipeline << " is not refused";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("run it in one process"), std::string::npos) << error.what();
  }
}

/// Each operator gets some of the shapes, spilled or not by turns, so that all operators together get all of them.
TEST_P(PartRunOf, HasTheBytesOfOneRunOnHostileTiles) {
  const std::vector<std::string> names = names_of_all_operators();
  const auto number = static_cast<std::size_t>(std::ranges::find(names, GetParam()) - names.begin());
  const auto shapes = hostile_shapes();
  const std::string other = (folder_ / "other.ply").string();
  for (std::size_t turn = 0; turn < 3; ++turn) {
    const auto& [name, shape] = shapes[(3 * number + turn) % shapes.size()];
    SCOPED_TRACE(name);
    std::mt19937_64 random(5);
    std::vector<Vec3> cloud(700), others(200);
    for (Vec3& p : cloud) p = shape(random);
    for (Vec3& p : others) p = shape(random);
    std::filesystem::remove(other);
    write_labelled_points(other, others);
    std::vector<std::vector<Vec3>> tiles = squares_of(cloud);
    tiles.push_back({});
    tiles.push_back({{1e4, 1e4, 0}});
    write_tiles(tiles);
    EngineOptions given = options();
    given.slab_points = 90;
    given.spill = turn % 2 == 1;
    const std::string pipeline = example_of(GetParam(), other).pipeline;
    if (looks_at_all(pipeline, inputs_.front())) GTEST_SKIP() << "is refused";
    expect_same(pipeline, given);
  }
}

INSTANTIATE_TEST_SUITE_P(EveryOperator, PartRunOf, testing::ValuesIn(names_of_all_operators()),
                         [](const auto& tested) { return tested.param; });

/// Chains with two sweeps, values of the whole cloud, selects, moves, and rows of the input.
const std::vector<std::string> kChains = {
    "knn(k=6) | normals | curvature",
    "sor | where(outlier == 0) | reneighbor | normals",
    "where(row >= 300 and classification != 2) | normals | set(id = row, as=uint64)",
    "set(x = x + 3, z = 2 * z) | normals",
    "knn(k=8) | normals | curvature | splats | fair(f=0.2, g=0.2) | reneighbor | normals",
    "knn(radius=0.8) | statistics(classification_mean, count) | density",
    "unique | where(row >= 100) | voxel(0.7) | normals | voxel(2, keep=centroid)",
    "poisson(0.1) | voxel(0.3) | poisson(0.5)",
    "knn(k=4) | components | where(component_size > 3) | reneighbor | components",
    "knn(radius=0.2) | dbscan(eps=0.2, min_points=4) | density",
    "knn(k=8) | normals | segments(angle=20) | where(segment_residual < 0.1)",
    "knn(k=8) | normals | orient",
    "knn(k=3) | normals | orient(viewpoint=[0.3,0.4,5])",
    "knn(radius=0.2) | normals | orient | where(normal_turned == 1) | reneighbor(k=5) | orient | components",
    "knn(k=6) | where(row >= 250 and classification != 2) | normals | orient | curvature",
    "ground(cell=0.02, window=0.04, threshold=0.01) | height(k=3) | where(height < 1)",
    "distance_to(OTHER) | take(OTHER, attributes=[classification, tree_id], k=5, most=0.3, missing=9)",
    "knn(k=6) | normals | m3c2(OTHER, cylinder=0.3, depth=0.2) | take(OTHER, attributes=tree_id)",
};

class PartRunThrough : public PartRun, public testing::WithParamInterface<std::string> {};

TEST_P(PartRunThrough, HostileTilesHasTheBytesOfOneRun) {
  for (const auto& [name, shape] : hostile_shapes()) {
    SCOPED_TRACE(name);
    std::mt19937_64 random(3);
    std::vector<Vec3> cloud(900), other(300);
    for (Vec3& p : cloud) p = shape(random);
    for (Vec3& p : other) p = shape(random);
    write_other({{}, other, {other.front(), {7e3, 0, 0}}});
    std::vector<std::vector<Vec3>> tiles = squares_of(cloud);
    tiles.push_back({});
    tiles.push_back({{1e4, 1e4, 0}});
    tiles.push_back({{std::numeric_limits<double>::quiet_NaN(), 0, 0}, cloud.front(), cloud.front()});
    write_tiles(tiles);
    EngineOptions spilling = options();
    spilling.spill = true;
    expect_same(with_other(GetParam()), name == "volume" ? spilling : options());
  }
}

INSTANTIATE_TEST_SUITE_P(Chains, PartRunThrough, testing::ValuesIn(kChains));

/// Returns divisions into tiles of any shape and order. Few points of a tile, or all, lie at its border.
std::vector<std::vector<std::vector<Vec3>>> divisions_of(const std::vector<Vec3>& cloud, std::mt19937_64& random) {
  std::vector<std::vector<std::vector<Vec3>>> divisions(4);
  for (auto& tiles : divisions) tiles.resize(6);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3& p = cloud[i];
    const auto slice = static_cast<std::size_t>(std::abs(std::fmod(7 * p.x + 3, 6)));
    divisions[0][std::isfinite(p.x) ? slice * 5 % 6 : 0].push_back(p);
    divisions[1][random() % 6].push_back(p);
    divisions[2][i < 5 ? i : 5].push_back(p);
    divisions[3][i / 40 % 6].push_back(p);
  }
  for (auto& tiles : divisions) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    tiles.insert(tiles.begin() + static_cast<std::ptrdiff_t>(random() % 6), {{nan, 0, 0}, {nan, nan, 1}});
    tiles.push_back({cloud[3], cloud[4], cloud[3], {3e3, -2e4, 1}});  // copies of points of other tiles
    tiles.push_back({});
  }
  return divisions;
}

TEST_F(PartRun, OrientsNormalsHoweverTilesAreCut) {
  std::mt19937_64 random(8);
  const std::filesystem::path flight = folder_ / "flight.csv";
  std::ofstream(flight) << "-9,0,0,3\n9999,5,5,2\n";
  const std::string by_trajectory = "orient(method=trajectory, trajectory=" + flight.string() + ")";
  for (const auto& [name, shape] : hostile_shapes()) {
    std::vector<Vec3> cloud(300);
    for (Vec3& p : cloud) p = shape(random);
    std::size_t number = 0;
    for (const auto& tiles : divisions_of(cloud, random)) {
      SCOPED_TRACE(name + ", division " + std::to_string(number));
      write_tiles(tiles);
      EngineOptions given = options();
      given.slab_points = 40;
      given.spill = number == 1;
      expect_same("knn(k=4) | normals | orient", given);
      if (number++ == 2) expect_same("knn(k=5) | set(gps_time = row, as=float64) | normals | " + by_trajectory, given);
    }
  }
}

/// Returns points of a hilly square of 200 metres with walls.
std::vector<Vec3> landscape(std::size_t count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::vector<Vec3> points(count);
  for (Vec3& p : points) {
    p = {200 * uniform(random), 200 * uniform(random), 0};
    p.z = 5 * std::sin(p.x / 20) + 4 * std::cos(p.y / 30) + 0.1 * uniform(random);
    if (std::fmod(p.x, 40) < 8 && std::fmod(p.y, 50) < 9) p.z += 6;
    if (uniform(random) < 0.1) p.z += 15 * uniform(random);
  }
  return points;
}

/// Divides points into sixteen squares, and adds a tile with a point far away.
std::vector<std::vector<Vec3>> sixteen_tiles_of(const std::vector<Vec3>& points) {
  std::vector<std::vector<Vec3>> tiles(17);
  for (const Vec3& p : points)
    tiles[4 * static_cast<std::size_t>(p.x / 50) + static_cast<std::size_t>(p.y / 50)].push_back(p);
  tiles.back() = {{150, 100, 3}, {9e3, 100, 5}};
  return tiles;
}

class PartRunOfTiles : public PartRun, public testing::WithParamInterface<std::string> {};

TEST_P(PartRunOfTiles, TakesLittleMoreThanTheirPoints) {
  const std::vector<Vec3> points = landscape(60'000, 1);
  write_tiles(sixteen_tiles_of(points));
  write_other(sixteen_tiles_of(landscape(60'000, 2)));
  EngineOptions thin = options();
  thin.slab_points = 150;
  const std::uint64_t swept = expect_same(with_other(GetParam()), thin);
  EXPECT_GT(swept, points.size());
  const std::uint64_t sweeps = GetParam().starts_with("knn") ? 2 : 1;
  EXPECT_LT(swept, 3 * sweeps * points.size());
}

INSTANTIATE_TEST_SUITE_P(InOrder, PartRunOfTiles,
                         testing::Values("unique", "voxel(3)", "voxel(1, keep=centroid)", "ground(cell=1, window=2)",
                                         "poisson(1.5)", "knn(k=6) | components", "knn(k=8) | normals | orient",
                                         "knn(radius=1.5) | dbscan(eps=1.5, min_points=6)",
                                         "knn(k=10) | normals | curvature | simplify(0.05, most=2)", "height(k=3)",
                                         "knn(k=8) | normals | m3c2(OTHER, cylinder=12, depth=4)", "distance_to(OTHER)",
                                         "distance_to(OTHER, most=0.5)",
                                         "take(OTHER, attributes=tree_id, k=4, vote=mean)",
                                         "take(OTHER, attributes=tree_id, most=0.2, missing=1)"));

/// Each point of a line decides about the next point, so the last tile depends on the first point.
TEST_F(PartRun, ReadsAsFarAsPointsDecideAboutEachOther) {
  constexpr std::size_t kLineTiles = 10, kInTile = 30;
  std::mt19937_64 random(1);
  std::vector<std::vector<Vec3>> tiles(kLineTiles);
  for (std::size_t i = 0; i < kLineTiles * kInTile; ++i) {
    const double least = static_cast<double>(i) / (kLineTiles * kInTile), most = least + 1.0 / (kLineTiles * kInTile);
    Vec3 p;
    double share;
    do {
      p = {0.9 * static_cast<double>(i), 0.01 * uniform(random), 0};
      share = static_cast<double>(coordinate_hash(p, kPoissonSeed)) * 0x1p-64;
    } while (share < least || share >= most);
    tiles[i / kInTile].push_back(p);
  }
  write_tiles(tiles);
  EngineOptions given = options();
  given.slab_points = 5;
  EXPECT_GT(expect_same("poisson(1)", given), 5 * kLineTiles * kInTile) << "tiles have read much of the line";
}

/// Each tile has four points, one of class 2, so the nearest points are in several tiles.
TEST_F(PartRun, ReadsAsManyTilesAsHoldTheNearestPoints) {
  std::vector<std::vector<Vec3>> tiles;
  for (const Vec3& p : landscape(40, 1)) tiles.push_back({p, p + Vec3{1, 0, 2}, p + Vec3{0, 1, 3}, p + Vec3{1, 1, 1}});
  write_tiles(tiles);
  expect_same("height(k=5)", options());
}

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
  EXPECT_THROW(plan_parts({cloud, normals, tiles, sweep_order}), UsageError);
  EXPECT_THROW(plan_parts({cloud, normals, {.points = folder_ / "one.ply"}, options()}), UsageError);
}

TEST_F(PartRun, IsRefusedWhereTilesCoverEachOther) {
  EngineOptions overwriting = options();
  overwriting.overwrite = true;
  const auto plan = [&](std::size_t copies) {
    write_tiles(std::vector(copies, cloud_for_examples(400, 1)));
    Outputs tiles;
    for (auto& input : inputs_) {  // LAS states in its header where the points lie
      InputCloud tile({input});
      input.replace_extension(".las");
      run(tile, build_chain(parse_pipeline("where(row >= 0)"), tile), {.points = input}, overwriting);
      tiles.tiles.push_back(folder_ / "parts" / input.filename());
    }
    InputCloud cloud(inputs_);
    plan_parts({cloud, build_chain(parse_pipeline("normals"), cloud), tiles, options()});
  };
  EXPECT_NO_THROW(plan(3));
  std::filesystem::remove_all(folder_ / "parts");
  try {
    plan(4);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("in the boxes of 4.0 of them"), std::string::npos) << error.what();
  }
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
