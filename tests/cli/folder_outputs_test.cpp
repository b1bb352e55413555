// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "pointsweep/reader.h"
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

/// All records of a file.
struct StoredPoints {
  Schema schema;
  std::vector<std::byte> records;
  std::size_t rows = 0;

  explicit StoredPoints(const std::filesystem::path& path) {
    const auto reader = open_reader(path);
    schema = reader->info().schema;
    rows = reader->info().count;
    records.resize(rows * schema.stride);
    for (std::size_t row = 0; row < rows;) row += reader->read(row, std::span(records).subspan(row * schema.stride));
  }
  double value(std::size_t row, const std::string& name) const {
    return value_of(schema.fields[schema.find(name).value()], records.data() + row * schema.stride);
  }
};

/// A folder of tiles of one surface, cut so that the neighbours of many points are in other tiles.
class FolderOutputs : public Tool {
 protected:
  FolderOutputs() {
    std::filesystem::create_directories(folder_ / "tiles/deep");
    made("generate statue all.ply -n 6000 --noise 0.001");
    const StoredPoints all(folder_ / "all.ply");
    std::map<std::string, std::string> texts;
    for (std::size_t row = 0; row < all.rows; ++row)
      texts[row % 7 == 0              ? "c"
            : all.value(row, "x") < 0 ? "a"
                                      : "b"] += fmt::format("{:.9f} {:.9f} {:.9f} {}\n", all.value(row, "x"),
                                                            all.value(row, "y"), all.value(row, "z"), row % 50);
    for (const auto& [name, text] : texts) write(name + ".xyz", "x y z weight\n" + text);
  }
  /// Makes the tiles a.las, b.ply, c.xyz and deep/a.laz.
  void make_mixed_tiles() {
    made("sort a.xyz tiles/a.las --axis y --no-provenance");
    made("sort b.xyz tiles/b.ply --axis x --keep x,y,z --no-provenance");
    std::filesystem::copy(folder_ / "c.xyz", folder_ / "tiles/c.xyz");
    made("generate statue tiles/deep/a.laz -n 700 --seed 5");
  }
  void make_tiles(const std::string& extension) {
    for (const char* name : {"a", "b", "c"})
      made(fmt::format("sort {0}.xyz tiles/{0}.{1} --axis y --no-provenance", name, extension));
  }
  std::vector<std::string> tiles_ = {"a.las", "b.ply", "c.xyz", "deep/a.laz"};

  /// Expects that the rows of the tiles in `out`, one tile after another, have the values of `merged` in all `fields`,
  /// to the last bit. A text file is read as float64, and its shortest decimals give the float32 that was written.
  void expect_seamless(const std::string& out, const std::string& merged, const std::vector<std::string>& fields) {
    const StoredPoints whole(folder_ / merged);
    std::size_t row = 0;
    for (const std::string& name : tiles_) {
      const StoredPoints tile(folder_ / out / name);
      for (std::size_t i = 0; i < tile.rows; ++i, ++row)
        for (const std::string& field : fields) {
          const bool is_float = whole.schema.fields[whole.schema.find(field).value()].type == Type::f32;
          const double stored = tile.value(i, field), wanted = whole.value(row, field);
          const double is = is_float ? static_cast<float>(stored) : stored;
          ASSERT_EQ(std::memcmp(&is, &wanted, sizeof is), 0) << name << " row " << i << " " << field << " " << is;
        }
    }
    EXPECT_EQ(row, whole.rows);
  }
  /// Expects that every tile in `out` has all attributes of its input, with their types, bits and values.
  void expect_inputs_kept(const std::string& out) {
    for (const std::string& name : tiles_) {
      const StoredPoints in(folder_ / "tiles" / name), tile(folder_ / out / name);
      ASSERT_EQ(in.rows, tile.rows) << name;
      for (const Field& field : in.schema.fields) {
        const auto at = tile.schema.find(field.name);
        ASSERT_TRUE(at) << name << " " << field.name;
        const Field& kept = tile.schema.fields[*at];
        EXPECT_TRUE(kept.type == field.type && kept.scale == field.scale && kept.bias == field.bias) << field.name;
        for (std::size_t i = 0; i < in.rows; ++i)
          ASSERT_EQ(in.value(i, field.name), tile.value(i, field.name)) << name << " row " << i << " " << field.name;
      }
    }
  }
};

TEST_F(FolderOutputs, HaveNoSeamsAndKeepWhatEachInputHas) {
  make_mixed_tiles();
  for (const char* options : {"--engine reference", "--memory 100M --threads 3", ""}) {
    made(std::string("curvature tiles merged.ply --recursive -k 12 --prefix p_ --force ") + options);
    made(std::string("curvature tiles out/ --recursive -k 12 --prefix p_ --force ") + options);
    expect_seamless("out", "merged.ply", {"p_nx", "p_ny", "p_nz", "p_k1", "p_k2"});
    expect_inputs_kept("out");
  }
  EXPECT_EQ(tool("verify tiles out --recursive").status, 0);
  const StoredPoints ply(folder_ / "out/b.ply"), las(folder_ / "out/a.las");
  EXPECT_FALSE(ply.schema.find("intensity")) << "an attribute of another tile";
  EXPECT_TRUE(las.schema.find("weight"));
}

TEST_F(FolderOutputs, OfPcdAndE57FilesHaveNoSeamsEither) {
  make_tiles("pcd");
  made("sort b.xyz tiles/b.e57 --axis y --no-provenance");
  std::filesystem::remove(folder_ / "tiles/b.pcd");
  tiles_ = {"a.pcd", "b.e57", "c.pcd"};
  for (const char* options : {"--memory 100M --threads 3", ""}) {
    made(std::string("curvature tiles merged.e57 -k 12 --prefix p_ --force ") + options);
    made(std::string("curvature tiles out/ -k 12 --prefix p_ --force ") + options);
    expect_seamless("out", "merged.e57", {"p_nx", "p_ny", "p_nz", "p_k1", "p_k2"});
    expect_inputs_kept("out");
  }
  EXPECT_EQ(tool("verify tiles out").status, 0);
}

TEST_F(FolderOutputs, SayThatTheyAreTilesAndKeepNoNoticeOfAttributesThatOthersHave) {
  make_mixed_tiles();
  const Result run = tool("normals tiles out/ --recursive");
  EXPECT_EQ(run.err.find("which tiles"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("wrote out/: 4 files, 6700 points"), std::string::npos) << run.err;
  EXPECT_NE(tool("info out/b.ply").out.find("tile 2 of 4; from b.ply and 3 more"), std::string::npos);
  refused(2, "verify out/b.ply", "name");
  refused(2, "verify out", "is a folder; name the inputs too: pointsweep verify tiles/ out");
  refused(2, "verify tiles out/b.ply", "is tile 2 of 4 of a run over several inputs");
}

TEST_F(FolderOutputs, HaveIntegersThatTheCommonTypeOfTheInputsDoesNotHold) {
  made("run a.xyz -o tiles/a.las --pipeline 'set(id = 18446744073709551615, as=uint64)'");
  made("run b.xyz -o tiles/b.las --pipeline 'set(id = -1, as=int64)'");
  refused(1, "normals tiles -o merged.las", "a.las: row 0: 'id' is 18446744073709551615");
  made("normals tiles out/");
  EXPECT_EQ(tool("verify tiles out").status, 0);
  refused(1, "run tiles out2/ --pipeline 'where(id > 0)'", "a.las: row 0: 'id' is 18446744073709551615");
}

TEST_F(FolderOutputs, AreFoundWrongByVerifyIfAValueIsChanged) {
  make_tiles("ply");
  made("normals tiles out/");
  EXPECT_EQ(tool("verify tiles out").status, 0);
  std::string text = contents(folder_ / "out/b.ply");
  text[text.size() - 1500] = static_cast<char>(text[text.size() - 1500] ^ 0x55);
  write("out/b.ply", text);
  EXPECT_EQ(tool("verify tiles out --sample 6000").status, 1);
  std::filesystem::remove(folder_ / "out/b.ply");
  refused(1, "verify tiles out", "out/b.ply: is missing, the output for tiles/b.ply");
}

TEST_F(FolderOutputs, RowsThatASelectLeavesOutAreMissingInEachTile) {
  make_mixed_tiles();
  for (const char* chain : {"where(z > 0.2) | normals", "normals | where(z > 0.2)", "where(z > 0.2)"}) {
    made(std::string("run tiles merged.ply --recursive --force --pipeline '") + chain + "'");
    made(std::string("run tiles out/ --recursive --force --pipeline '") + chain + "'");
    expect_seamless("out", "merged.ply", {"z"});
    if (std::string(chain).find("normals") != std::string::npos) expect_seamless("out", "merged.ply", {"nx", "nz"});
  }
}

TEST_F(FolderOutputs, ATileWithoutRowsIsWrittenEmptyAndNamed) {
  make_tiles("las");
  const Result run = tool("run tiles out/ --pipeline 'where(x < 0 && weight != 0) | normals'");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("no point passed; out/b.las is empty."), std::string::npos) << run.err;
  EXPECT_EQ(StoredPoints(folder_ / "out/b.las").rows, 0u);
  EXPECT_GT(StoredPoints(folder_ / "out/a.las").rows, 0u);
  const Result none = tool("run tiles none/ --pipeline 'where(x > 100) | normals'");
  EXPECT_NE(none.err.find("no point passed for 3 outputs, which are empty, the first none/a.las"), std::string::npos)
      << none.err;
}

TEST_F(FolderOutputs, EmptyTilesAndTilesOfOnePointAreTiles) {
  make_tiles("ply");
  write("tiles/aa.ply",
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\n"
        "end_header\n");
  write("tiles/z.ply",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "end_header\n0 0 0\n");
  tiles_ = {"a.ply", "aa.ply", "b.ply", "c.ply", "z.ply"};
  made("normals tiles merged.ply");
  made("normals tiles out/");
  expect_seamless("out", "merged.ply", {"x", "nx", "ny", "nz"});
  EXPECT_EQ(StoredPoints(folder_ / "out/aa.ply").rows, 0u);
  EXPECT_EQ(StoredPoints(folder_ / "out/z.ply").rows, 1u);
}

TEST_F(FolderOutputs, PointsThatAreNotFiniteStayOrAreDroppedInTheirTile) {
  make_tiles("ply");
  write("tiles/n.xyz", "0.1 0.2 0.3\nnan 1 1\n0.1 0.2 0.4\n");
  tiles_ = {"a.ply", "b.ply", "c.ply", "n.xyz"};
  for (const char* options : {"", "--nonfinite drop"}) {
    made(std::string("normals tiles merged.ply --force ") + options);
    made(std::string("normals tiles out/ --force ") + options);
    expect_seamless("out", "merged.ply", {"nx", "ny", "nz"});
    EXPECT_EQ(StoredPoints(folder_ / "out/n.xyz").rows, *options == 0 ? 3u : 2u);
  }
  made("normals tiles las/ --output-format las");
  EXPECT_EQ(StoredPoints(folder_ / "las/n.las").rows, 2u) << "LAS cannot hold NaN";
  refused(1, "normals tiles kept/ --output-format las --nonfinite keep", "cannot hold them");
  refused(1, "normals tiles kept/ --nonfinite refuse", "row 1 of tiles/n.xyz");
  EXPECT_FALSE(exists("kept/a.las"));
}

TEST_F(FolderOutputs, MovedPointsGetTheTypeOfTheirTile) {
  make_mixed_tiles();
  made("fair tiles merged.ply --recursive -k 24");
  made("fair tiles out/ --recursive -k 24");
  const StoredPoints merged(folder_ / "merged.ply"), las(folder_ / "out/a.las"), ply(folder_ / "out/b.ply");
  const Field& x = las.schema.fields[*las.schema.find("x")];
  EXPECT_EQ(x.type, Type::i32);
  for (std::size_t i = 0; i < las.rows; ++i) ASSERT_NEAR(las.value(i, "x"), merged.value(i, "x"), x.scale * 0.51);
  EXPECT_EQ(ply.schema.fields[*ply.schema.find("x")].type, Type::f64);
  for (std::size_t i = 0; i < ply.rows; ++i) ASSERT_EQ(ply.value(i, "x"), merged.value(las.rows + i, "x"));
  expect_seamless("out", "merged.ply", {"nx", "splat_length"});
}

TEST_F(FolderOutputs, KeepChoosesByTheNamesOfAllTiles) {
  make_mixed_tiles();
  made("normals tiles out/ --recursive --keep x,y,z,weight,ny");
  EXPECT_TRUE(StoredPoints(folder_ / "out/c.xyz").schema.find("weight"));
  EXPECT_FALSE(StoredPoints(folder_ / "out/b.ply").schema.find("weight"));
  EXPECT_FALSE(StoredPoints(folder_ / "out/b.ply").schema.find("nx"));
  EXPECT_TRUE(StoredPoints(folder_ / "out/b.ply").schema.find("ny"));
}

TEST_F(FolderOutputs, OneFormatForAllMayBeChosen) {
  make_mixed_tiles();
  made("normals tiles out/ --recursive --output-format PLY");
  tiles_ = {"a.ply", "b.ply", "c.ply", "deep/a.ply"};
  made("normals tiles merged.ply --recursive");
  expect_seamless("out", "merged.ply", {"nx", "ny", "nz"});
  EXPECT_EQ(tool("verify tiles out --recursive").status, 0);
  refused(2, "normals tiles out.ply --output-format las", "its name says its format");
  refused(2, "normals tiles out2/ --output-format off", "'off' is not one of");
}

TEST_F(FolderOutputs, InputsOfFormatsThatAreNotWrittenNeedAnother) {
  make_tiles("ply");
  write("tiles/m.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n");
  refused(2, "normals tiles out/", "tiles/m.off: files named *.off are not written; choose a format");
  EXPECT_FALSE(exists("out"));
  made("normals tiles out/ --output-format laz");
  EXPECT_EQ(StoredPoints(folder_ / "out/m.laz").rows, 3u);
}

TEST_F(FolderOutputs, NothingIsOverwrittenThatWasNotMeant) {
  make_tiles("ply");
  std::filesystem::create_directory(folder_ / "out");
  write("out/b.ply", "precious");
  refused(1, "normals tiles out", "out/b.ply: exists already");
  EXPECT_EQ(contents(folder_ / "out/b.ply"), "precious");
  EXPECT_FALSE(exists("out/a.ply")) << "known before the work";
  refused(2, "normals tiles tiles/ --force", "is also the folder of inputs");
  refused(2, "normals 'tiles/*.ply' tiles/ --force", "is an input");
  std::filesystem::create_directory_symlink("tiles", folder_ / "link");
  refused(2, "normals tiles link --force", "is also the folder of inputs");
  refused(2, "normals 'tiles/*.ply' link --force", "is an input");
  refused(2, "normals tiles tiles/deep --recursive", "is in the folder of inputs");
  std::filesystem::create_hard_link(folder_ / "tiles/c.ply", folder_ / "out/c.ply");
  refused(2, "normals tiles out --force", "is an input");
  std::filesystem::remove(folder_ / "out/c.ply");
  made("normals tiles out --force");
  EXPECT_NE(contents(folder_ / "out/b.ply"), "precious");
}

TEST_F(FolderOutputs, InputsOfOneNameAreRefusedWithARemedy) {
  make_tiles("ply");
  std::filesystem::copy(folder_ / "tiles/a.ply", folder_ / "tiles/deep/a.ply");
  refused(2, "normals tiles tiles/deep -o out/", "would both be written as out/a.ply; name the folder that holds both");
  refused(2, "normals tiles 'tiles/deep/*' -o out/", "would both be written as out/a.ply");
  made("normals tiles out/ --recursive");
  EXPECT_TRUE(exists("out/deep/a.ply"));
}

TEST_F(FolderOutputs, MayBeNamedFirstOrLastAndAFolderOfPointsIsNotTakenForOne) {
  make_tiles("ply");
  std::filesystem::create_directory(folder_ / "out");
  made("normals tiles/a.ply tiles/b.ply out -k 5");
  EXPECT_TRUE(exists("out/a.ply") && exists("out/b.ply"));
  made("normals -o new/ 'tiles/*.ply' -k 5");
  EXPECT_TRUE(exists("new/c.ply"));
  refused(2, "normals a.xyz b.xyz tiles", "as the last of");
}

TEST_F(FolderOutputs, WhatNeedsOneOutputIsRefused) {
  make_tiles("ply");
  refused(2, "normals tiles out/ --order sweep", "leave out --order sweep, or name one output file");
  refused(2, "sort tiles out/", "sort puts the points of all inputs in one order");
  refused(2, "neighbors tiles out/", "name a .npy file");
  refused(2, "normals tiles out", "end the name of a folder of outputs with '/'");
  refused(1, "normals tiles none/out/", "the folder none does not exist");
  refused(1, "normals none out/", "none: no such file");
  EXPECT_FALSE(exists("out"));
}

TEST_F(FolderOutputs, ADryRunWritesNothing) {
  make_tiles("las");
  const Result run = tool("normals tiles out/ --dry-run");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("outputs       3, one for each input"), std::string::npos) << run.out;
  EXPECT_FALSE(exists("out"));
  EXPECT_EQ(run.out.find("note"), std::string::npos) << run.out;
  made("normals tiles out/");
  EXPECT_THAT(made("normals tiles out/ --dry-run", ".out"), testing::HasSubstr("a.las: exists already"));
  refused(2, "normals tiles out/ --dry-run --order sweep", "leave out --order sweep");
}

TEST_F(FolderOutputs, JsonPipelinesReportsAndStatisticsWork) {
  make_tiles("ply");
  write("p.json", R"([{"type": "knn", "k": 9}, {"type": "normals"}])");
  made("run tiles out/ --pipeline p.json --stats s.json --report r.html");
  made("normals tiles flags/ -k 9 --no-provenance");
  const auto stats = nlohmann::json::parse(contents(folder_ / "s.json"));
  EXPECT_EQ(stats["points"], 6000);
  EXPECT_GT(stats["bytes"]["written"], 6000 * 36);
  EXPECT_TRUE(exists("r.html"));
  tiles_ = {"a.ply", "b.ply", "c.ply"};
  made("normals tiles merged.ply -k 9");
  expect_seamless("out", "merged.ply", {"nx"});
  expect_seamless("flags", "merged.ply", {"nx"});
}

TEST_F(FolderOutputs, AreCompleteOrAbsentAndResumeLeavesFinishedOnes) {
  make_tiles("ply");
  made("generate statue tiles/big.xyz -n 20000 --seed 9");
  made("normals tiles whole/ -k 6");
  const std::string arguments = "normals tiles out/ -k 6 --resume kept --checkpoint-seconds 0 ";
  const Result stopped = tool_under("ulimit -f 1800 && exec", arguments);  // blocks of 512 bytes
  EXPECT_EQ(stopped.status, 1) << stopped.err;
  ASSERT_TRUE(exists("out/a.ply") && exists("out/b.ply")) << stopped.err;
  EXPECT_FALSE(exists("out/big.xyz"));
  std::size_t complete = 0;  // c.ply may be completed in the background while big.xyz fails
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "out")) {
    EXPECT_FALSE(entry.path().filename().string().starts_with('.')) << entry.path();
    ++complete;
  }
  EXPECT_NE(stopped.err.find(fmt::format("{} of 4 outputs are complete", complete)), std::string::npos) << stopped.err;
  const auto written = std::filesystem::last_write_time(folder_ / "out/a.ply");
  made(arguments);
  EXPECT_EQ(std::filesystem::last_write_time(folder_ / "out/a.ply"), written) << "it was finished";
  for (const char* name : {"a.ply", "b.ply", "big.xyz", "c.ply"})
    EXPECT_EQ(contents(folder_ / "out" / name), contents(folder_ / "whole" / name)) << name;
  EXPECT_FALSE(exists("kept"));
}

TEST_F(FolderOutputs, AfterASuddenDeathResumeLeavesFinishedOnesAndRemovesWhatWasBegun) {
  make_tiles("ply");
  made("generate statue tiles/big.xyz -n 200000 --seed 9");
  made("normals tiles whole/ -k 3");
  const std::string arguments = "normals tiles out/ -k 3 --resume kept --checkpoint-seconds 0 ";
  const std::string command =
      "cd '" + folder_.string() + "' && { " + program() + " " + arguments +
      " 2>/dev/null & } && while kill -0 $! && ! { [ -e out/a.ply ] && [ -e out/b.ply ]; }; do :; done; kill -9 $!; "
      "wait $!";
  std::system(command.c_str());
  ASSERT_TRUE(exists("out/a.ply") && exists("out/b.ply"));
  const auto written = std::filesystem::last_write_time(folder_ / "out/a.ply");
  if (exists("kept")) made(arguments);  // without the folder, the process was complete before the signal came
  EXPECT_EQ(std::filesystem::last_write_time(folder_ / "out/a.ply"), written);
  for (const char* name : {"a.ply", "b.ply", "big.xyz", "c.ply"})
    EXPECT_TRUE(contents(folder_ / "out" / name) == contents(folder_ / "whole" / name)) << name;
  const std::filesystem::directory_iterator all(folder_ / "out");
  EXPECT_EQ(std::distance(begin(all), end(all)), 4);
}

TEST_F(FolderOutputs, ThereMayBeMoreThanFilesThatCanBeOpenAtOnce) {
  std::filesystem::create_directory(folder_ / "many");
  for (int i = 0; i < 60; ++i)
    made(fmt::format("generate statue many/{}{} -n 40 --seed {}", 100 + i, i % 2 == 0 ? ".ply" : ".las", i));
  made("normals many free/ -k 5");
  const Result tight = tool_under("ulimit -n 24 && exec", "normals many tight/ -k 5");
  EXPECT_EQ(tight.status, 0) << tight.err;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "free"))
    EXPECT_TRUE(contents(entry.path()) == contents(folder_ / "tight" / entry.path().filename())) << entry.path();
}

TEST_F(FolderOutputs, AFinishedOneThatWasReplacedMeanwhileIsNotOverwritten) {
  make_tiles("ply");
  made("generate statue tiles/big.xyz -n 20000 --seed 9");
  const std::string arguments = "normals tiles out/ -k 6 --resume kept --checkpoint-seconds 0 ";
  EXPECT_EQ(tool_under("ulimit -f 1800 && exec", arguments).status, 1);
  ASSERT_TRUE(exists("out/a.ply"));
  std::filesystem::remove(folder_ / "out/a.ply");
  write("other", "precious");
  std::filesystem::rename(folder_ / "other", folder_ / "out/a.ply");
  refused(1, arguments, "out/a.ply: exists already");
  EXPECT_EQ(contents(folder_ / "out/a.ply"), "precious");
  std::filesystem::remove(folder_ / "out/a.ply");
  made(arguments);
  made("normals tiles whole/ -k 6");
  EXPECT_EQ(contents(folder_ / "out/a.ply"), contents(folder_ / "whole/a.ply"));
}

}  // namespace
}  // namespace pointsweep
