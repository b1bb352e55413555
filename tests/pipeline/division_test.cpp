// SPDX-License-Identifier: MIT
/// Outputs that are divided among files: each point once, in the tile that the formula names, in the order of the
/// input, with the same bytes for any threads and memory.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "pointsweep/arrays.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "pointsweep/pipeline/output/divided_writer.h"
#include "pointsweep/pipeline/output/divider.h"
#include "pointsweep/pipeline/run/part_run.h"
#include "pointsweep/pipeline/run/task_values.h"
#include "pointsweep/program/pipeline.h"
#include "pointsweep/storage/local/folder_storage.h"
#include "tests/formats/temporary_folder.h"
#include "tests/pipeline/in_memory.h"
#include "tests/storage/written_bytes.h"
#include "tests/support/scratch_in_memory.h"
#include "tests/support/watching.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

constexpr double kSize = 500;

/// A point as a file of the output has it.
struct Row {
  double x, y, z;
  std::uint64_t id;
  bool buffer;
};

std::vector<Row> rows_of(const fs::path& file) {
  const auto reader = open_reader(file);
  const Schema& schema = reader->info().schema;
  std::vector<std::byte> records(reader->info().count * schema.stride);
  for (std::uint64_t row = 0; row < reader->info().count;)
    row += reader->read(row, std::span(records).subspan(row * schema.stride));
  const auto value = [&](const char* name, const std::byte* record) {
    return value_of(schema.fields[schema.find(name).value()], record);
  };
  std::vector<Row> rows;
  for (std::size_t at = 0; at < records.size(); at += schema.stride) {
    const std::byte* const r = records.data() + at;
    rows.push_back({value("x", r), value("y", r), value("z", r), static_cast<std::uint64_t>(value("id", r)),
                    schema.find("buffer") && value("buffer", r) != 0});
  }
  return rows;
}

std::map<std::string, std::vector<Row>> files_in(const fs::path& folder) {
  std::map<std::string, std::vector<Row>> files;
  for (const auto& entry : fs::directory_iterator(folder)) files[entry.path().stem().string()] = rows_of(entry.path());
  return files;
}

std::map<std::string, std::string> bytes_in(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder))
    files[entry.path().filename().string()] = contents(entry.path());
  return files;
}

/// Files of points at borders of tiles, one unit in the last place beside borders, on both sides of 0, and anywhere.
class Division : public testing::Test {
 protected:
  Division() { fs::create_directory(folder_ / "in"); }

  /// Writes the input. `not_finite`: also writes points without a finite place.
  fs::path input(bool not_finite) {
    std::vector<double> values = {0.0, -0.0, 5e-324, -5e-324, 0.1, 499.99999};
    for (int i = -3; i <= 3; ++i)
      for (const double towards : {-1e9, 1e9}) {
        values.push_back(i * kSize);
        values.push_back(std::nextafter(i * kSize, towards));
        values.push_back(i * kSize + (towards > 0 ? 4e-4 : -4e-4));
      }
    std::mt19937 random(7);
    for (int i = 0; i < 20; ++i) values.push_back(std::uniform_real_distribution<>(-1700, 1700)(random));
    if (not_finite)
      for (const double v : {std::nan(""), std::numeric_limits<double>::infinity()}) values.push_back(v);
    std::vector<double> xyz;
    for (const double x : values)
      for (const double y : values) xyz.insert(xyz.end(), {x, y, x - 1 + y * 2});
    std::vector<std::uint32_t> ids;
    for (std::uint32_t i = 0; i < xyz.size() / 3; ++i) ids.push_back(i);
    points_ = ids.size();
    const fs::path file = folder_ / "in/all.ply";
    fs::remove(file);
    Schema schema;
    for (const char* axis : {"x", "y", "z"}) schema.append(axis, Type::f64);
    schema.append("id", Type::u32);
    const auto writer = create_writer({.path = file, .schema = schema, .count = ids.size(), .extras = nullptr});
    std::vector<std::byte> record(schema.stride);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      for (std::size_t a = 0; a < 3; ++a) set_value(schema.fields[a], record.data(), xyz[3 * i + a]);
      set_value(schema.fields[3], record.data(), ids[i]);
      writer->write(record);
    }
    writer->finish();
    return file;
  }

  Statistics divide(const fs::path& file, const std::string& out, EngineOptions options) {
    InputCloud cloud({file});
    return run(cloud, {}, {.points = folder_ / out}, options);
  }

  static EngineOptions tiles(double size, std::array<double, 2> origin = {0, 0}) {
    EngineOptions options;
    options.division.tile = size;
    options.division.tile_origin = origin;
    options.resources.threads = 2;
    return options;
  }

  TemporaryFolder folder_;
  std::size_t points_ = 0;
};

/// Expects the row inside its tile by the definition, comparing with the edges of the tile.
void expect_in_tile(const std::string& name, const Row& row, double size, std::array<double, 2> origin) {
  const std::size_t between = name.find('_');
  const double corner[2] = {std::stod(name.substr(0, between)), std::stod(name.substr(between + 1))};
  const double place[2] = {row.x, row.y};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double i = std::round((corner[axis] - origin[axis]) / size);
    EXPECT_LE(origin[axis] + i * size, place[axis]) << name;
    EXPECT_LT(place[axis], origin[axis] + (i + 1) * size) << name;
  }
}

TEST_F(Division, PutsEachPointIntoTheTileOfItsCoordinatesInTheFileForEveryFormat) {
  struct Case {
    const char* extension;
    double size;
    std::array<double, 2> origin;
    FileLayout layout;
  };
  for (const Case& c : {Case{"ply", 500, {0, 0}, {}},
                        {"ply", 0.1 * 3000, {0.1, -0.3}, {}},
                        {"las", 500, {0, 0}, {}},
                        {"laz", 500, {0, 0}, {.scale = Vec3{0.001, 0.01, 1}}},
                        {"las", 62.5, {12.5, 0}, {.scale = Vec3{7, 3, 1}}},
                        {"csv", 500, {0, 0}, {}},
                        {"csv", 500, {0, 0}, {.decimals = 2}},
                        {"xyz", 33.3, {0, 1}, {.decimals = 0}},
                        {"pcd", 500, {0, 0}, {}},
                        {"e57", 500, {0, 0}, {}}}) {
    SCOPED_TRACE(fmt::format("{} {}", c.extension, c.size));
    EngineOptions options = tiles(c.size, c.origin);
    options.layout = c.layout;
    const fs::path file = input(std::string(c.extension) == "ply");
    divide(file, fmt::format("out/*.{}", c.extension), options);
    std::set<std::uint64_t> seen;
    for (const auto& [name, rows] : files_in(folder_ / "out")) {
      EXPECT_FALSE(rows.empty());
      for (std::size_t i = 0; i < rows.size(); ++i) {
        EXPECT_TRUE(seen.insert(rows[i].id).second) << rows[i].id;
        EXPECT_TRUE(i == 0 || rows[i - 1].id < rows[i].id) << "in the order of the input";
        const bool is_placed = std::isfinite(rows[i].x) && std::isfinite(rows[i].y);
        EXPECT_EQ(is_placed, name != "unplaced");
        if (is_placed) expect_in_tile(name, rows[i], c.size, c.origin);
      }
    }
    EXPECT_EQ(seen.size(), points_);
    fs::remove_all(folder_ / "out");
  }
}

TEST_F(Division, BuffersHoldThePointsAroundATileThatHasPoints) {
  const fs::path file = input(true);
  EngineOptions options = tiles(kSize);
  options.division.tile_buffer = 40;
  divide(file, "out/*.ply", options);
  const auto files = files_in(folder_ / "out");
  std::map<std::uint64_t, Row> all;
  for (const auto& [name, rows] : files)
    for (const Row& row : rows) EXPECT_TRUE(row.buffer || all.emplace(row.id, row).second);
  EXPECT_EQ(all.size(), points_);
  for (const auto& [name, rows] : files) {
    if (name == "unplaced") continue;
    std::set<std::uint64_t> expected, found;
    const double x = std::stod(name), y = std::stod(name.substr(name.find('_') + 1));
    for (const auto& [id, p] : all) {
      const bool is_own = p.x >= x && p.x < x + kSize && p.y >= y && p.y < y + kSize;
      if (!is_own && p.x >= x - 40 && p.x < x + kSize + 40 && p.y >= y - 40 && p.y < y + kSize + 40)
        expected.insert(id);
    }
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i].buffer) found.insert(rows[i].id);
      EXPECT_TRUE(i == 0 || rows[i - 1].id < rows[i].id);
    }
    EXPECT_EQ(found, expected) << name;
  }
}

TEST_F(Division, HasTheSameBytesForAnyThreadsAndMemory) {
  const fs::path file = input(true);
  EngineOptions options = tiles(kSize);
  options.division.tile_buffer = 3;
  for (const char* out : {"ply", "laz"}) {
    std::map<std::string, std::string> first;
    for (const unsigned threads : {1u, 2u, 64u})
      for (const std::uint64_t megabytes : {80, 2000}) {
        options.resources.threads = threads;
        options.resources.memory_bytes = megabytes << 20;
        divide(file, fmt::format("out/*.{}", out), options);
        const auto bytes = bytes_in(folder_ / "out");
        if (first.empty()) first = bytes;
        EXPECT_TRUE(bytes == first) << threads << " threads, " << megabytes;
        fs::remove_all(folder_ / "out");
      }
  }
}

TEST_F(Division, WaitsInTheTemporaryFolderForTheSameFiles) {
  Schema schema;
  for (const char* axis : {"x", "y", "z"}) schema.append(axis, Type::f64);
  constexpr std::uint64_t kDivided = 20'000;
  std::vector<std::byte> records(kDivided * schema.stride);
  std::mt19937 random(3);
  for (std::uint64_t i = 0; i < kDivided; ++i)
    for (std::size_t a = 0; a < 3; ++a)
      set_value(schema.fields[a], records.data() + i * schema.stride, static_cast<double>(random() % 1000));
  std::map<std::string, std::string> first;
  for (const std::uint64_t bytes : {100'000'000, 300'000, 5'000, 40}) {
    fs::create_directory(folder_ / "out");
    OutputDivision division;
    division.tile = 77;
    division.tile_buffer = 5;
    std::size_t made = 0;
    const auto scratch = [&]() -> std::unique_ptr<Scratch> { return ++made, std::make_unique<ScratchInMemory>(); };
    DividedWriter writer({.path = folder_ / "out/*.ply", .schema = schema, .count = kDivided, .extras = nullptr},
                         division, {bytes, scratch});
    for (std::size_t at = 0; at < records.size(); at += 1000 * schema.stride)
      writer.write(std::span(records).subspan(at, 1000 * schema.stride));
    writer.finish();
    EXPECT_EQ(made, bytes > 1'000'000 ? 0u : 1u);
    EXPECT_EQ(writer.files(), 169u);
    const auto files = bytes_in(folder_ / "out");
    if (first.empty()) first = files;
    EXPECT_TRUE(files == first) << bytes;
    fs::remove_all(folder_ / "out");
  }
}

/// Divides the points in tasks, which share a folder as processes would.
void divide_in_tasks(std::vector<fs::path> inputs, const fs::path& out, EngineOptions options, const fs::path& scratch,
                     std::size_t tasks) {
  InputCloud cloud(inputs);
  const Chain chain;
  const Outputs outputs{.points = out};
  const SharedRequest request{cloud, chain, outputs, options};
  EXPECT_GE(piece_bytes(request), cloud.schema().stride);
  EXPECT_EQ(plan_ranges(request).size(), inputs.size());
  const std::unique_ptr<Storage> place = shared_storage(scratch);
  std::vector<std::string> names;
  const std::uint64_t rows = cloud.count() / tasks;
  EngineOptions allowed = options;
  allowed.overwrite = true;
  const SharedRequest of_task{cloud, chain, outputs, allowed};
  for (std::size_t task = 0; task <= tasks; ++task) {
    names.push_back(fmt::format("00-{}-a", task));
    const std::uint64_t last = task == tasks ? cloud.count() : (task + 1) * rows;
    cut_range(of_task, {task * rows, last - task * rows}, *place, names.back());
  }
  join_pieces(request, *place, names, "joined");
  std::uint64_t written = 0;
  for (std::size_t task = 0; task <= tasks; ++task)
    written += write_pieces(of_task, task, tasks + 1, *place, "joined").points_written;
  EXPECT_EQ(written, cloud.count());
}

TEST_F(Division, OfManyProcessesHasTheBytesOfOne) {
  const fs::path ply = input(true), las = folder_ / "in/few.las";
  InputCloud whole({ply});
  run(whole, build_chain(parse_pipeline("where(abs(x) < 100 and abs(y) < 600)"), whole), {.points = las}, {});
  struct Case {
    std::vector<fs::path> inputs;
    const char* out;
    OutputDivision division;
  };
  for (const Case& c : {Case{{ply}, "out/*.ply", {.tile = kSize}},
                        {{ply, las}, "out/*.ply", {.tile = kSize, .tile_buffer = 33}},
                        {{las, ply, las}, "out/a_*.csv", {.tile = 70, .tile_origin = {1, 2}}},
                        {{las}, "out/*.laz", {.tile = kSize, .tile_buffer = 20}},
                        {{las, las}, "out/*.las", {.split = "id"}}}) {
    SCOPED_TRACE(fmt::format("{} of {}", c.out, c.inputs.size()));
    EngineOptions options;
    options.division = c.division;
    options.resources.threads = 2;
    InputCloud cloud(c.inputs);
    run(cloud, {}, {.points = folder_ / c.out}, options);
    const auto of_one = bytes_in(folder_ / "out");
    EXPECT_GE(of_one.size(), 8u);
    for (const std::size_t tasks : {1, 5}) {
      fs::remove_all(folder_ / "out");
      fs::create_directory(folder_ / "scratch");
      divide_in_tasks(c.inputs, folder_ / c.out, options, folder_ / "scratch", tasks);
      EXPECT_TRUE(bytes_in(folder_ / "out") == of_one) << tasks;
      fs::remove_all(folder_ / "scratch");
    }
    fs::remove_all(folder_ / "out");
  }
}

TEST_F(Division, OfManyProcessesHasTheBytesOfOneInEveryFormatOrIsRefused) {
  const fs::path ply = input(false), las = folder_ / "in/all.las";
  InputCloud whole({ply});
  run(whole, {}, {.points = las}, {});
  std::set<std::string> same, refused;
  for (const fs::path& from : {ply, las})
    for (const std::string_view extension : writable_extensions()) {
      const std::string out = fmt::format("out/*{}", extension), name = from.extension().string() + " " + out;
      SCOPED_TRACE(name);
      const EngineOptions options = tiles(kSize);
      InputCloud cloud({from});
      const Chain chain;
      const Outputs outputs{.points = folder_ / out};
      try {
        plan_ranges({cloud, chain, outputs, options});
      } catch (const UsageError& error) {
        EXPECT_NE(std::string(error.what()).find("in one process"), std::string::npos) << error.what();
        refused.insert(name);
        continue;
      }
      divide(from, out, options);
      const auto of_one = bytes_in(folder_ / "out");
      fs::remove_all(folder_ / "out");
      fs::create_directory(folder_ / "scratch");
      divide_in_tasks({from}, folder_ / out, options, folder_ / "scratch", 3);
      EXPECT_TRUE(bytes_in(folder_ / "out") == of_one);
      same.insert(name);
      fs::remove_all(folder_ / "out");
      fs::remove_all(folder_ / "scratch");
    }
  EXPECT_EQ(same.size() + refused.size(), 2 * writable_extensions().size());
  for (const char* one : {".las out/*.laz", ".las out/*.copc.laz", ".las out/*.csv", ".ply out/*.ply"})
    EXPECT_TRUE(same.contains(one)) << one;
  EXPECT_TRUE(refused.contains(".ply out/*.las"));
}

TEST_F(Division, OfManyProcessesRefusesWhatNeedsAllPointsBeforeTheWork) {
  const fs::path ply = input(false), las = folder_ / "in/all.las";
  InputCloud whole({ply});
  run(whole, {}, {.points = las}, {});
  const auto plan = [&](const fs::path& input, const std::string& pipeline, const std::string& out,
                        EngineOptions options) {
    InputCloud cloud({input});
    const Chain chain = pipeline.empty() ? Chain() : build_chain(parse_pipeline(pipeline), cloud);
    const Outputs outputs{.points = folder_ / out};
    return plan_ranges({cloud, chain, outputs, options});
  };
  const auto refusal = [&](const auto&... asked) { return sentence_of<UsageError>([&] { plan(asked...); }); };
  EXPECT_NE(refusal(ply, "", "out/*.las", tiles(kSize)).find("Which points have no place"), std::string::npos);
  EXPECT_NE(refusal(ply, "where(x > 0)", "out/*.ply", tiles(kSize)).find("no stage changes"), std::string::npos);
  EngineOptions stated = tiles(kSize);
  stated.layout.scale = Vec3{0.01, 0.01, 0.01};
  EXPECT_NE(refusal(las, "", "out/*.las", stated).find("depends on all points"), std::string::npos);
  EngineOptions dropping = tiles(kSize);
  dropping.nonfinite = Nonfinite::drop;
  EXPECT_EQ(plan(las, "", "out/*.laz", dropping).size(), 1u);
}

TEST_F(Division, OfManyProcessesNeverReplacesAFileUnasked) {
  const fs::path file = input(false);
  EngineOptions options = tiles(kSize);
  divide(file, "out/*.ply", options);
  const auto before = bytes_in(folder_ / "out");
  fs::create_directory(folder_ / "scratch");
  const auto again = [&] { divide_in_tasks({file}, folder_ / "out/*.ply", options, folder_ / "scratch", 2); };
  EXPECT_NE(sentence_of<Error>(again).find("holds point files already"), std::string::npos);
  EXPECT_TRUE(bytes_in(folder_ / "out") == before);
}

TEST(Pieces, SurviveDamage) {
  const auto expect_survives = [](const auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    const std::vector<std::byte> bytes = encoded(value);
    const auto again = [](std::span<const std::byte> damaged) { return encoded<const Value>(decoded<Value>(damaged)); };
    EXPECT_EQ(hex(again(bytes)), hex(bytes));
    expect_survives_damage(bytes, again);
  };
  const PiecesOfRange first{{{{-3, 7}, 5, 9}, {{0, 0}, 0, 2}}}, second{{{{0, 0}, 1, 1}}};
  expect_survives(first);
  expect_survives(files_of({"00-0-a", "00-1-b"}, std::vector{first, second}));
}

TEST(Pieces, AreSharedOutByTheirPoints) {
  PiecesOfRange range;
  for (std::int64_t i = 0; i < 100; ++i) range.pieces.push_back({{i, 0}, 10, 10 + static_cast<std::uint64_t>(i % 7)});
  const FilesOfRanges all = files_of({"a"}, std::vector{range});
  for (const std::size_t tasks : {1, 3, 99, 1000}) {
    std::vector<std::size_t> shared;
    for (std::size_t task = 0; task < tasks; ++task) {
      const std::vector<std::size_t> own = all.of_task(task, tasks);
      EXPECT_LE(own.size(), 2 + 130 / tasks);
      shared.insert(shared.end(), own.begin(), own.end());
    }
    EXPECT_EQ(shared.size(), 100u);
    EXPECT_TRUE(std::ranges::is_sorted(shared));
  }
}

TEST_F(Division, TellsHowManyPointsAreOnTheirWayIntoFilesWithAndWithoutBuffers) {
  const fs::path file = input(false);
  for (const double buffer : {0.0, 20.0}) {
    std::vector<std::uint64_t> told;
    Watching watching([&](const Progress& progress) {
      if (progress.phase != std::string("completing")) return;
      told.push_back(progress.done);
      EXPECT_EQ(progress.total, points_);
    });
    EngineOptions options;
    options.observer = &watching;
    options.overwrite = true;
    options.division = {.tile = kSize, .tile_buffer = buffer};
    divide(file, "out/*.ply", options);
    EXPECT_GT(told.size(), 10u);
    EXPECT_TRUE(std::ranges::is_sorted(told));
    EXPECT_EQ(told.back(), points_);
  }
}

TEST_F(Division, ByValuesHasAFileForEach) {
  Schema schema;
  for (const char* axis : {"x", "y", "z"}) schema.append(axis, Type::i32);
  schema.append("id", Type::u32), schema.append("small", Type::i8), schema.append("wide", Type::u64);
  std::vector<std::byte> records(300 * schema.stride);
  for (std::uint64_t i = 0; i < 300; ++i) {
    std::byte* const record = records.data() + i * schema.stride;
    set_value(schema.fields[3], record, static_cast<double>(i));
    set_value(schema.fields[4], record, static_cast<double>(i % 3) - 1);
    const std::uint64_t wide = ~std::uint64_t{0} - i % 2;  // float64 cannot distinguish both values
    std::memcpy(record + schema.fields[5].offset, &wide, sizeof wide);
  }
  const auto split_by = [&](const std::string& attribute) {
    fs::remove_all(folder_ / "out");
    fs::create_directory(folder_ / "out");
    OutputDivision division;
    division.split = attribute;
    DividedWriter writer({.path = folder_ / "out/a_*.las", .schema = schema, .count = 300, .extras = nullptr}, division,
                         {1 << 20});
    writer.write(records);
    writer.finish();
    return files_in(folder_ / "out");
  };
  const auto small = split_by("SMALL");
  EXPECT_EQ(small.size(), 3u);
  for (const auto& [name, rows] : small) {
    EXPECT_EQ(rows.size(), 100u);
    for (const Row& row : rows) EXPECT_EQ(name, fmt::format("a_small_{}", static_cast<int>(row.id % 3) - 1));
  }
  const auto wide = split_by("wide");
  ASSERT_EQ(wide.size(), 2u);
  EXPECT_EQ(wide.at("a_wide_18446744073709551615").front().id, 0u);
  EXPECT_EQ(wide.at("a_wide_18446744073709551614").front().id, 1u);
}

TEST_F(Division, RefusesWhatItCannotDo) {
  const fs::path file = input(false);
  const auto refusal = [&](EngineOptions options, const std::string& out = "out/*.ply") {
    return sentence_of<Error>([&] { divide(file, out, options); });
  };
  EXPECT_NE(refusal(tiles(500), "out/all.ply").find("name a folder"), std::string::npos);
  EngineOptions both = tiles(500);
  both.division.split = "id";
  EXPECT_NE(refusal(both).find("two runs"), std::string::npos);
  EngineOptions wide = tiles(500);
  wide.division.tile_buffer = 500.1;
  EXPECT_NE(refusal(wide).find("not from 0 to the size of a tile"), std::string::npos);
  EngineOptions alone;
  alone.division.tile_buffer = 1;
  EXPECT_NE(refusal(alone).find("belong to --tile"), std::string::npos);
  EngineOptions resumed = tiles(500);
  resumed.resume_folder = folder_ / "done";
  EXPECT_NE(refusal(resumed).find("cannot be resumed"), std::string::npos);
  EngineOptions values;
  values.division.split = "z";
  EXPECT_NE(refusal(values).find("'z' has no whole numbers"), std::string::npos);
  values.division.split = "klass";
  EXPECT_NE(refusal(values).find("the points have no attribute 'klass'; they have x, y, z, id"), std::string::npos);
  EXPECT_NE(refusal(tiles(1e-14)).find("choose larger ones"), std::string::npos);
  EXPECT_NE(refusal(tiles(500), "in/*.ply").find("in the folder of the outputs"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "out")) << "the folder of a run that is refused does not stay";
}

TEST_F(Division, OfMoreThanTenThousandFilesIsRefusedBeforeTheFirst) {
  std::vector<double> xyz;
  for (int i = 0; i <= 10'000; ++i) xyz.insert(xyz.end(), {static_cast<double>(i), 0, 0});
  const auto divide_arrays = [&](std::size_t points, bool overwrite) {
    std::vector<std::unique_ptr<Reader>> readers;
    readers.push_back(std::make_unique<ArrayReader>(std::span<const double>(xyz.data(), points * 3)));
    InputCloud cloud(std::move(readers));
    EngineOptions options = tiles(1);
    options.overwrite = overwrite;
    return run(cloud, {}, {.points = folder_ / "out/*.ply"}, options).files_written;
  };
  EXPECT_NE(sentence_of<UsageError>([&] { divide_arrays(10'001, false); }).find("more than 10000 files"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
  EXPECT_EQ(divide_arrays(10'001, true), 10'001u);
}

TEST_F(Division, LeavesCompleteFilesOnlyWhereOneCannotBeWritten) {
  const fs::path file = input(false);
  fs::create_directories(folder_ / "out/0_0.ply");  // a folder has the name of a tile
  EXPECT_NE(sentence_of<Error>([&] { divide(file, "out/*.ply", tiles(500)); }), "");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "out"), {}), 1) << "found before the first file";
  fs::remove(folder_ / "out/0_0.ply");
  divide(file, "out/*.ply", tiles(500));
  const auto whole = bytes_in(folder_ / "out");
  EXPECT_NE(sentence_of<Error>([&] { divide(file, "out/*.ply", tiles(250)); }).find("holds point files already"),
            std::string::npos);
  EXPECT_TRUE(bytes_in(folder_ / "out") == whole);
}

TEST(TileGrid, NamesEdgesWithTheDigitsOfSizeAndOrigin) {
  EXPECT_EQ(TileGrid(500, {0, 0}).edge_text(0, 3), "1500");
  EXPECT_EQ(TileGrid(500, {0, 0}).edge_text(0, -1), "-500");
  EXPECT_EQ(TileGrid(500, {-0.0, -0.0}).edge_text(0, 0), "0");
  EXPECT_EQ(TileGrid(0.1, {0, 0}).edge_text(1, 3), "0.3");
  EXPECT_EQ(TileGrid(62.5, {0, 0.25}).edge_text(0, 1), "62.5");
  EXPECT_EQ(TileGrid(62.5, {0, 0.25}).edge_text(1, 1), "62.75");
  EXPECT_EQ(TileGrid(1e6, {0, 0}).edge_text(0, 5'000), "5000000000");
}

TEST(TileGrid, FindsTheTileBetweenWhoseEdgesACoordinateLies) {
  std::mt19937_64 random(11);
  for (int n = 0; n < 20'000; ++n) {
    const double size =
        std::ldexp(std::uniform_real_distribution<>(1, 2)(random), static_cast<int>(random() % 20) - 10);
    const double origin = std::uniform_real_distribution<>(-1e7, 1e7)(random);
    const TileGrid grid(size, {origin, 0});
    double x = grid.edge(0, static_cast<std::int64_t>(random() % 2001) - 1000);
    if (n % 3 == 1) x = std::nextafter(x, -1e300);
    if (n % 3 == 2) x = std::uniform_real_distribution<>(-1e7, 1e7)(random);
    const std::int64_t i = grid.tile_of(0, x);
    EXPECT_LE(origin + static_cast<double>(i) * size, x);
    EXPECT_LT(x, origin + static_cast<double>(i + 1) * size);
  }
}

}  // namespace
}  // namespace pointsweep
