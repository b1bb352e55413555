// SPDX-License-Identifier: MIT
/// Runs with an output for each input: no seams, each tile has the layout of its input, and tiles are complete or
/// absent.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <thread>

#include "pointsweep/fail.h"
#include "pointsweep/formats/registry.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/run/preview.h"
#include "pointsweep/storage/local/output_file.h"
#include "tests/formats/las_test_file.h"
#include "tests/formats/temporary_folder.h"
#include "tests/pipeline/hostile_clouds.h"
#include "tests/support/reference_engine.h"
#include "tests/support/watching.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// The schema and all records of a file.
struct FileContent {
  Schema schema;
  std::vector<std::byte> records;
  std::uint64_t rows = 0;

  explicit FileContent(const fs::path& path) {
    const auto reader = open_reader(path);
    schema = reader->info().schema;
    rows = reader->info().count;
    records.resize(rows * schema.stride);
    for (std::uint64_t row = 0; row < rows;) row += reader->read(row, std::span(records).subspan(row * schema.stride));
  }
  double value(std::uint64_t row, const Field& field) const {
    return value_of(field, records.data() + row * schema.stride);
  }
};

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0 || (a != a && b != b); }

/// A reader of a file that calls `hook` before each read.
class HookedReader final : public Reader {
 public:
  HookedReader(const fs::path& path, std::function<void()> hook) : inner_(open_reader(path)), hook_(std::move(hook)) {
    info_ = inner_->info();
  }
  std::size_t read(std::uint64_t row, std::span<std::byte> records) override {
    hook_();
    return inner_->read(row, records);
  }

 private:
  std::unique_ptr<Reader> inner_;
  std::function<void()> hook_;
};

/// Tiles of four formats over the same space, so that most neighbours of a point are in other tiles. Some points are in
/// two tiles, some rows are not finite, and no two tiles have the same attributes.
class Tiles : public testing::Test {
 protected:
  Tiles() {
    fs::create_directories(folder_ / "in/deep");
    las_test::File a, b;
    a.format = 3;
    a.count = 400;
    a.user_header = "of the user";
    a.vlrs = {las_test::vlr("maker", 7, "content")};
    a.scale = {1e-9, 1e-9, 1e-9};
    a.offset = {0, 0, 0.25};
    b.minor = 4;
    b.format = 6;
    b.count = 300;
    b.scale = {5e-10, 5e-10, 5e-10};
    b.offset = {0.5, 0.125, 0};
    b.seed = 6;
    folder_.write("in/a.las", a.bytes());
    folder_.write("in/b.las", b.bytes());
    write_ply("in/c.ply", 500, 21);
    write_text("in/d.xyz", 350, 21);
    write_ply("in/deep/c.ply", 200, 22);
  }

  void write_ply(const std::string& name, int rows, unsigned seed) const {
    std::string text = fmt::format(
        "ply\nformat ascii 1.0\ncomment of {}\nelement vertex {}\nproperty double x\n"
        "property double y\nproperty double z\nproperty ushort label\nend_header\n",
        name, rows);
    for (const auto& [p, i] : points(rows, seed)) text += fmt::format("{} {} {} {}\n", p.x, p.y, p.z, i % 60'000);
    folder_.write(name, text);
  }
  void write_text(const std::string& name, int rows, unsigned seed) const {
    std::string text = "x y z weight\n0.1 nan 0 5\n";
    for (const auto& [p, i] : points(rows, seed)) text += fmt::format("{} {} {} {}\n", p.x, p.y, p.z, i / 8.0);
    folder_.write(name, text + "inf 0 0 1\n");
  }
  static std::vector<std::pair<Vec3, int>> points(int rows, unsigned seed) {
    std::mt19937_64 random(seed);
    std::vector<std::pair<Vec3, int>> all;
    for (int i = 0; i < rows; ++i) all.emplace_back(hostile_shapes()[i % 3 == 0 ? 1 : 0].second(random), i);
    return all;
  }

  std::vector<fs::path> inputs() const {
    std::vector<fs::path> all;
    for (const std::string& name : names_) all.push_back(folder_ / "in" / name);
    return all;
  }
  Outputs tiles(const std::string& out = "out") const {
    Outputs outputs;
    for (const std::string& name : names_) outputs.tiles.push_back(folder_ / out / name);
    return outputs;
  }
  EngineOptions options() const {
    EngineOptions options;
    options.slab_points = 90;
    options.cell_points = 32;
    options.resources.threads = 2;
    options.resources.memory_bytes = 256 << 20;
    options.resources.temp_folder = folder_.path();
    return options;
  }
  Statistics run_all(const std::string& pipeline, const Outputs& outputs, const EngineOptions& options) const {
    InputCloud cloud(inputs());
    return run_cloud(cloud, pipeline, outputs, options);
  }
  static Statistics run_cloud(InputCloud& cloud, const std::string& pipeline, const Outputs& outputs,
                              const EngineOptions& options) {
    return run(cloud, build_chain(parse_pipeline(pipeline), cloud), outputs, options);
  }
  /// Returns the inputs as a cloud. Input `number` calls `hook` before each read.
  InputCloud hooked(std::size_t number, std::function<void()> hook) const {
    std::vector<std::unique_ptr<Reader>> readers;
    for (const fs::path& path : inputs())
      readers.push_back(readers.size() == number ? std::make_unique<HookedReader>(path, hook) : open_reader(path));
    return InputCloud(std::move(readers));
  }

  /// Expects that the rows of the tiles, one tile after another, have the computed attributes of `merged`, to the last
  /// bit. A text file is read as float64, and its shortest decimals give the float32 that was written.
  void expect_no_seams(const fs::path& merged) const {
    const FileContent whole(merged);
    const Schema given = InputCloud(inputs()).schema();
    std::uint64_t first = 0;
    for (const fs::path& path : tiles().tiles) {
      const FileContent tile(path);
      for (const Field& field : whole.schema.fields) {
        if (given.find(field.name)) continue;
        const auto own = tile.schema.find(field.name);
        ASSERT_TRUE(own) << path << " " << field.name;
        for (std::uint64_t row = 0; row < tile.rows; ++row) {
          const double value = tile.value(row, tile.schema.fields[*own]);
          ASSERT_TRUE(
              same_bits(field.type == Type::f32 ? static_cast<float>(value) : value, whole.value(first + row, field)))
              << path << " row " << row << " " << field.name << " " << value;
        }
      }
      first += tile.rows;
    }
    EXPECT_EQ(first, whole.rows);
  }

  /// Returns the contents of all files in a folder, by relative path.
  std::map<std::string, std::string> files(const std::string& below = "out") const {
    std::map<std::string, std::string> all;
    if (fs::exists(folder_ / below))
      for (const auto& entry : fs::recursive_directory_iterator(folder_ / below))
        if (entry.is_regular_file()) all[fs::relative(entry.path(), folder_ / below)] = contents(entry.path());
    return all;
  }

  TemporaryFolder folder_;
  std::vector<std::string> names_ = {"a.las", "b.las", "c.ply", "d.xyz", "deep/c.ply"};
};

constexpr std::array kTiledPipelines = {
    "normals",
    "knn(k=6) | normals | curvature | splats",
    "knn(radius=0.1) | normals",
    "where(x < 0.2 && z > -1) | normals",
    "unique | normals | sor(multiplier=1) | where(outlier == 0) | normals",
    "normals | splats | fair(f=9, g=9) | reneighbor | normals",
    "normals | splats | fair(f=9, g=9) | resort",
    "normals | where(nz > 0)",
    "decimate(0.8) | voxel(0.05) | normals",
    "normals | voxel(0.1, keep=hash)",
    "poisson(0.05) | normals",
    "ground(cell=0.1, window=0.5)",
    "knn(k=2) | components",
    "knn(radius=0.1) | normals | dbscan(eps=0.08, min_points=4) | segments(angle=20) | orient",
    "knn(radius=0.05) | normals | components(distance=0.03) | where(component_size > 3)",
    "ground(cell=0.2, window=1) | height(k=3)",
};

TEST_F(Tiles, ARefusedValueIsNamedByItsRowAlsoWhereNothingIsMade) {
  constexpr int kRows = 10'000, kRefused = 9'001;
  std::string text = "x y z\n";
  for (int i = 0; i < kRows; ++i) text += fmt::format("{} {} 0\n", i >= kRefused ? 1e60 : i % 100, i / 100);
  folder_.write("in/far.xyz", text);
  EngineOptions narrow = options();
  narrow.positions = Type::f32;
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"far.xyz"}, std::vector<std::string>{"c.ply", "far.xyz"}})
    for (const bool merges : {true, false}) {
      std::vector<fs::path> paths;
      Outputs outputs;
      for (const std::string& name : names) {
        paths.push_back(folder_ / "in" / name);
        if (!merges) outputs.tiles.push_back((folder_ / "far" / name).replace_extension("ply"));
      }
      if (merges) outputs.points = folder_ / "far.ply";
      InputCloud cloud(paths);
      try {
        run_cloud(cloud, "where(y < 1000)", outputs, narrow);
        ADD_FAILURE() << "nothing was refused";
      } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr(fmt::format("Row {}", kRefused)));
        EXPECT_THAT(error.what(), HasSubstr(names.size() > 1 ? "far.xyz" : "Row"));
      }
    }
}

TEST_F(Tiles, HaveTheBytesOfTheMergedRunInEveryPipeline) {
  for (const std::string pipeline : kTiledPipelines) {
    SCOPED_TRACE(pipeline);
    EngineOptions some = options();
    some.overwrite = true;
    run_all(pipeline, {.points = folder_ / "merged.ply"}, some);
    some.resources.threads = 3;
    some.resources.memory_bytes = 200 << 20;
    some.slab_points = 300;
    run_all(pipeline, tiles(), some);
    expect_no_seams(folder_ / "merged.ply");
    if (HasFatalFailure()) return;
  }
}

TEST_F(Tiles, HaveTheBytesOfTheMergedRunOfTheReference) {
  EngineOptions reference = options();
  reference.engine = Engine::reference;
  run_all("knn(k=7) | normals | curvature", {.points = folder_ / "merged.ply"}, reference);
  run_all("knn(k=7) | normals | curvature", tiles(), reference);
  expect_no_seams(folder_ / "merged.ply");
}

TEST_F(Tiles, AreTheFilesThatRunsOverEachInputAloneWriteIfStagesLookAtNoNeighbour) {
  EngineOptions plain = options();
  plain.provenance = false;
  run_all("where(x < 0.3)", tiles(), plain);
  for (std::size_t t = 0; t < names_.size(); ++t) {
    InputCloud alone({inputs()[t]});
    const fs::path output = folder_ / ("alone" + fs::path(names_[t]).extension().string());
    EngineOptions replacing = plain;
    replacing.overwrite = true;
    run_cloud(alone, "where(x < 0.3)", {.points = output}, replacing);
    EXPECT_TRUE(contents(output) == contents(tiles().tiles[t])) << names_[t];
  }
}

TEST_F(Tiles, KeepTheHeadersOfTheirInputs) {
  EngineOptions plain = options();
  plain.provenance = false;
  run_all("normals", tiles(), plain);
  for (const std::size_t t : {0, 1}) {
    InputCloud alone({inputs()[t]});
    run_cloud(alone, "normals", {.points = folder_ / fmt::format("alone{}.las", t)}, plain);
    const std::string one = contents(folder_ / fmt::format("alone{}.las", t)), tile = contents(tiles().tiles[t]);
    ASSERT_EQ(one.size(), tile.size());
    std::uint32_t points_at = 0;
    std::memcpy(&points_at, one.data() + 96, 4);
    // The headers are equal: normals and ranges of extra bytes come later in the file.
    EXPECT_EQ(one.substr(0, 375), tile.substr(0, 375));
    EXPECT_NE(one.substr(points_at), tile.substr(points_at));
  }
}

TEST_F(Tiles, OfLazAreWrittenAndReadThroughTheTemporaryFolder) {
  if (!format_of_output("a.laz")->is_built_in()) GTEST_SKIP() << "built without LAZ";
  for (const std::string name : {"a", "b"}) {
    InputCloud cloud({folder_ / ("in/" + name + ".las")});
    run_cloud(cloud, "where(x < 1e9)", {.points = folder_ / ("in/" + name + ".laz")}, options());
  }
  names_ = {"a.laz", "b.laz", "c.ply"};
  run_all("normals", {.points = folder_ / "merged.ply"}, options());
  run_all("normals", tiles(), options());
  expect_no_seams(folder_ / "merged.ply");
}

TEST_F(Tiles, ThatLoseAllRowsAreEmptyFilesAndNamedInOneSentence) {
  const Statistics statistics = run_all("where(label > 450) | normals", tiles(), options());
  EXPECT_EQ(FileContent(folder_ / "out/a.las").rows, 0u);
  EXPECT_EQ(FileContent(folder_ / "out/c.ply").rows, 49u);
  EXPECT_EQ(statistics.points_written, 49u);
  EXPECT_THAT(statistics.warnings,
              testing::Contains(HasSubstr("no point passed for 4 outputs, which are empty, the first ")));
}

TEST_F(Tiles, PointsThatAreNotFiniteAreDroppedFromTheirTileAlone) {
  EngineOptions dropping = options();
  dropping.nonfinite = Nonfinite::drop;
  const Statistics statistics = run_all("normals", tiles(), dropping);
  EXPECT_EQ(statistics.dropped, 2u);
  run_all("normals", {.points = folder_ / "merged.ply"}, dropping);
  expect_no_seams(folder_ / "merged.ply");
  EXPECT_EQ(FileContent(folder_ / "out/d.xyz").rows, 350u);
}

/// A folder of n tiles must not be listed for each of them, which would take time proportional to n².
TEST_F(Tiles, LookForWhatKilledRunsHaveLeftBeforeTheFirstOfThemAlone) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  const auto left = [&](const char* folder) { return folder_ / fmt::format("out/{}/.c.ply.{}.part", folder, child); };
  fs::create_directories(folder_ / "out/deep");
  folder_.write(fs::relative(left("deep"), folder_.path()).string(), "half");
  InputCloud cloud = hooked(2, [&] {
    if (fs::exists(folder_ / "out/a.las")) folder_.write(fs::relative(left("."), folder_.path()).string(), "half");
  });
  run_cloud(cloud, "normals", tiles(), options());
  EXPECT_FALSE(fs::exists(left("deep")));
  EXPECT_TRUE(fs::exists(left(".")));
}

TEST_F(Tiles, SayWhichTileOfWhichRunTheyAre) {
  run_all("normals", tiles(), options());
  const auto lines = open_reader(folder_ / "out/d.xyz")->info().provenance;
  EXPECT_THAT(lines, testing::Contains(HasSubstr("tile 4 of 5")));
  EXPECT_THAT(lines, testing::Contains(HasSubstr("d.xyz")));
  EXPECT_THAT(lines, testing::Not(testing::Contains(HasSubstr("c.ply"))));
}

TEST_F(Tiles, AreRefusedTogetherWithWhatNeedsOneOutput) {
  const auto sentence = [&](const Outputs& outputs, const EngineOptions& options) {
    return sentence_of<UsageError>([&] { run_all("normals", outputs, options); });
  };
  EngineOptions sweep = options();
  sweep.order = Order::sweep;
  EXPECT_THAT(sentence(tiles(), sweep), HasSubstr("leave out --order sweep, or name one output file"));
  Outputs both = tiles();
  both.points = folder_ / "all.ply";
  EXPECT_THAT(sentence(both, options()), HasSubstr("cannot be combined with an output of all points"));
  both = tiles();
  both.arrays = {{"normal", folder_ / "n.npy"}};
  EXPECT_THAT(sentence(both, options()), HasSubstr("cannot be combined with an output of all points"));
  Outputs fewer = tiles();
  fewer.tiles.pop_back();
  EXPECT_THAT(sentence(fewer, options()), HasSubstr("4 outputs are named for 5 inputs"));
  Outputs over = tiles();
  over.tiles[1] = inputs()[0];
  EXPECT_THAT(sentence(over, options()), HasSubstr("is an input"));
  over.tiles[1] = over.tiles[0];
  EXPECT_THAT(sentence(over, options()), HasSubstr(over.tiles[0].string()));
  EXPECT_TRUE(files().empty());
  EXPECT_FALSE(fs::exists(folder_ / "out")) << "a folder that a run made and left empty";
}

TEST_F(Tiles, AreNotBegunIfOneOfThemExists) {
  fs::create_directories(folder_ / "out");
  folder_.write("out/d.xyz", "precious");
  EXPECT_THAT(sentence_of<Error>([&] { run_all("normals", tiles(), options()); }), HasSubstr("d.xyz: exists already"));
  EXPECT_EQ(files(), (std::map<std::string, std::string>{{"d.xyz", "precious"}}));
  EXPECT_FALSE(fs::exists(folder_ / "out/deep"));
}

TEST_F(Tiles, ADryRunNamesThemAndMakesNothing) {
  InputCloud cloud(inputs());
  const Chain chain = build_chain(parse_pipeline("normals"), cloud);
  EXPECT_THAT(to_text(preview(cloud, chain, options(), tiles())), HasSubstr("outputs       5, one for each input"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  EngineOptions sweep = options();
  sweep.order = Order::sweep;
  EXPECT_THROW(preview(cloud, chain, sweep, tiles()), UsageError);
}

/// Runs in which reading the third input fails, while its tile is written, as soon as the first two tiles are complete.
class StoppedTiles : public Tiles {
 protected:
  template <class Failure>
  InputCloud failing_late() const {
    return hooked(2, [this] {
      if (completes("a.las") && completes("b.las")) throw Failure();
    });
  }
  /// Returns false if the tile is not begun. Else waits until the tile is complete, which another thread may write, and
  /// returns whether it is.
  bool completes(const char* name) const {
    const fs::path tile = folder_ / "out" / name;
    const auto is_there = [&] { return fs::exists(tile); };
    if (!is_there() && !fs::exists(OutputFile::unfinished_path(tile))) return false;
    for (int i = 0; i < 1000 && !is_there(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return is_there();
  }
  struct ReadError : Error {
    ReadError() : Error("in/c.ply: the disk fails.") {}
  };
  void expect_two_complete_tiles(const std::map<std::string, std::string>& whole) const {
    const std::map<std::string, std::string> now = files();
    EXPECT_EQ(now.size(), 2u);
    for (const char* name : {"a.las", "b.las"}) EXPECT_TRUE(now.contains(name) && now.at(name) == whole.at(name));
    EXPECT_FALSE(fs::exists(folder_ / "out/deep")) << "a folder that a run made and left empty";
  }
};

TEST_F(StoppedTiles, AreCompleteOrAbsentAndTheErrorSaysHowManyThereAre) {
  run_all("normals", tiles("whole"), options());
  InputCloud cloud = failing_late<ReadError>();
  EXPECT_THAT(sentence_of<Error>([&] { run_cloud(cloud, "normals", tiles(), options()); }),
              HasSubstr("the disk fails. 2 of 5 outputs are complete and stay."));
  expect_two_complete_tiles(files("whole"));
}

TEST_F(StoppedTiles, AreCompleteOrAbsentAfterAnInterruption) {
  run_all("normals", tiles("whole"), options());
  InputCloud cloud = failing_late<Cancelled>();
  EXPECT_THROW(run_cloud(cloud, "normals", tiles(), options()), Cancelled);
  expect_two_complete_tiles(files("whole"));
}

TEST_F(StoppedTiles, AreNotWrittenFromAnInputThatHasChangedMeanwhile) {
  bool done = false;
  InputCloud cloud = hooked(1, [&] {
    if (done || !completes("a.las")) return;
    std::ofstream(folder_ / "in/d.xyz", std::ios::app) << "1 2 3 4\n";
    done = true;
  });
  EXPECT_THAT(sentence_of<Error>([&] { run_cloud(cloud, "normals", tiles(), options()); }),
              HasSubstr("d.xyz: was written to while it was read"));
  EXPECT_TRUE(done);
  EXPECT_FALSE(fs::exists(folder_ / "out/d.xyz"));
  EXPECT_EQ(files().size(), 3u);
}

class ResumedTiles : public StoppedTiles {
 protected:
  EngineOptions resuming() const {
    EngineOptions resuming = options();
    resuming.resume_folder = folder_ / "kept";
    resuming.checkpoint_seconds = 0;
    return resuming;
  }
  /// Stops a run when two tiles are complete.
  void stop_while_writing(const std::string& pipeline) const {
    InputCloud cloud = failing_late<Cancelled>();
    EXPECT_THROW(run_cloud(cloud, pipeline, tiles(), resuming()), Cancelled);
    EXPECT_EQ(files().size(), 2u);
  }
  fs::file_time_type time_of(const std::string& name) const { return fs::last_write_time(folder_ / "out" / name); }
};

TEST_F(ResumedTiles, AreNotCompletedIfAnyInputHasChangedSinceTheRunBegan) {
  stop_while_writing("normals");
  bool done = false;
  InputCloud cloud = hooked(2, [&] {
    if (!std::exchange(done, true)) std::ofstream(folder_ / "in/d.xyz", std::ios::app) << "1 2 3 4\n";
  });
  EXPECT_THAT(sentence_of<Error>([&] { run_cloud(cloud, "normals", tiles(), resuming()); }),
              HasSubstr("d.xyz: was written to while it was read"));
  EXPECT_TRUE(done);
  EXPECT_EQ(files().size(), 2u);
}

TEST_F(ResumedTiles, AreSkippedIfTheyAreCompleteAndTheOthersHaveTheBytesOfARunWithoutStops) {
  for (const std::size_t number : {0, 3, 4, 5}) {
    const std::string pipeline = kTiledPipelines[number];
    SCOPED_TRACE(pipeline);
    fs::remove_all(folder_ / "out");
    fs::remove_all(folder_ / "whole");
    run_all(pipeline, tiles("whole"), options());
    stop_while_writing(pipeline);
    const auto a = time_of("a.las"), b = time_of("b.las");
    run_all(pipeline, tiles(), resuming());
    EXPECT_TRUE(files() == files("whole"));
    EXPECT_EQ(time_of("a.las"), a);
    EXPECT_EQ(time_of("b.las"), b);
    EXPECT_FALSE(fs::exists(folder_ / "kept"));
  }
}

TEST_F(ResumedTiles, AreTheSameAtWhicheverReportTheRunWasStopped) {
  const char* pipeline = "normals | where(nz > 0)";
  std::uint64_t reports = 0, stop = 0;
  EngineOptions stopping = resuming();
  Watching watching([&](const Progress&) {
    if (++reports == stop) throw Cancelled();
  });
  stopping.observer = &watching;
  run_all(pipeline, tiles("whole"), stopping);
  const std::uint64_t all = reports;
  for (stop = 1; stop <= all; stop += 1 + all / 12) {
    SCOPED_TRACE(fmt::format("stopped at report {} of {}", stop, all));
    fs::remove_all(folder_ / "out");
    reports = 0;
    EXPECT_THROW(run_all(pipeline, tiles(), stopping), Cancelled);
    for (const auto& [name, bytes] : files()) EXPECT_TRUE(files("whole").at(name) == bytes) << name;
    run_all(pipeline, tiles(), stopping);  // the count of the hook goes on, so the run is not stopped again
    EXPECT_TRUE(files() == files("whole"));
  }
}

TEST_F(ResumedTiles, ThatAreNoLongerThoseOfTheRunAreNotTakenForThem) {
  stop_while_writing("normals");
  const auto unlink_and_write = [&](const char* bytes) {  // the new file often has the inode of the old one
    fs::remove(folder_ / "out/a.las");
    folder_.write("out/a.las", bytes);
  };
  unlink_and_write("precious");
  EXPECT_THAT(sentence_of<Error>([&] { run_all("normals", tiles(), resuming()); }), HasSubstr("a.las: exists already"));
  EXPECT_EQ(contents(folder_ / "out/a.las"), "precious");
  fs::remove(folder_ / "out/a.las");
  run_all("normals", tiles(), resuming());
  run_all("normals", tiles("whole"), options());
  EXPECT_TRUE(files() == files("whole"));
}

}  // namespace
}  // namespace pointsweep
