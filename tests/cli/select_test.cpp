// SPDX-License-Identifier: MIT
/// The operators where, sor and unique as a user runs them, on files of every format.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class SelectStages : public Tool {
 protected:
  /// Writes a text file of x, y, z and a number for each row that `keep` chooses.
  void write_rows(const std::string& name, bool (*keep)(int)) {
    std::string text = "x y z level\n";
    for (int i = 0; i < 900; ++i)
      if (keep(i)) text += fmt::format("{} {} {} {}\n", i % 30, i / 30 * 0.5, (i * 37 % 101) * 0.01, i % 7);
    write(name, text);
  }
  std::string points_in(const std::string& name) {
    const std::string text = tool("info " + name).out;
    const std::size_t at = text.find("  points ");
    return text.substr(at, text.find('\n', at) - at);
  }
  nlohmann::json info(const std::string& name) { return nlohmann::json::parse(tool("info --json " + name).out); }
};

TEST_F(SelectStages, EveryFormatGetsTheRowsThatAreLeft) {
  write_rows("all.txt", [](int) { return true; });
  write_rows("some.txt", [](int i) { return i % 7 > 3 || i % 30 == 2; });
  for (const char* extension : {"ply", "las", "txt", "csv"}) {
    for (const char* order : {"input", "sweep"}) {
      const std::string options = fmt::format(" --no-provenance -f -q --order {} --pipeline ", order);
      const std::string got = fmt::format("got.{}", extension), expected = fmt::format("expected.{}", extension);
      EXPECT_EQ(made("run all.txt " + got + options + "'where(level > 3 || x == 2) | normals'", got),
                made("run some.txt " + expected + options + "'normals'", expected))
          << extension << ", " << order;
      EXPECT_EQ(made("run all.txt " + got + options + "'where(level > 3 || x == 2)'", got),
                made("run some.txt " + expected + options + "'unique'", expected))
          << extension << ", " << order;
    }
  }
}

TEST_F(SelectStages, ALasHeaderCountsThoseThatAreLeft) {
  write_rows("all.txt", [](int) { return true; });
  made("run all.txt all.las -q --pipeline 'unique'");
  made("run all.las some.las -q --pipeline 'where(y >= 3 && y < 5)'");
  const nlohmann::json some = info("some.las");
  const nlohmann::json& file = some.is_array() ? some[0] : some.contains("files") ? some["files"][0] : some;
  EXPECT_EQ(file["points"], 120);
  EXPECT_NE(file.dump().find("4.5"), std::string::npos) << file.dump();
}

TEST_F(SelectStages, NoRowLeavesAFileWithoutPoints) {
  write_rows("all.txt", [](int) { return true; });
  for (const char* extension : {"ply", "las", "txt"}) {
    for (const char* order : {"input", "sweep"}) {
      const std::string name = fmt::format("none.{}", extension);
      const Result result = tool(
          fmt::format("run all.txt {} -f --order {} --pipeline 'sor | where(level > 100) | normals'", name, order));
      EXPECT_EQ(result.status, 0) << result.err;
      EXPECT_NE(result.err.find("no point passed; " + name + " is empty"), std::string::npos) << result.err;
      EXPECT_NE(result.err.find("0 points of 900"), std::string::npos) << result.err;
      EXPECT_NE(tool("info " + name).out.find("points      0"), std::string::npos);
    }
  }
}

TEST_F(SelectStages, SeveralInputsOfDifferentAttributesAreOneCloud) {
  write_rows("a.txt", [](int i) { return i < 500; });
  write("b.txt", "x y z\n0 0 0\n1 1 9\n1 1 9\n");
  const std::string text =
      made("run a.txt b.txt -o out.txt --no-provenance --pipeline 'unique | where(level == 0 && z < 5)'", "out.txt");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'),
            72 + 1 + 0);  // rows 0, 7, ... 497 and the header; the first row of b equals row 0 of a
}

TEST_F(SelectStages, VerifyFindsAMissingRowAndAWrongOutlier) {
  write_rows("all.txt", [](int) { return true; });
  made("run all.txt out.txt --pipeline 'where(level != 3) | sor(multiplier=1)' -q");
  EXPECT_NE(tool("verify out.txt").out.find("mean_distance outlier"), std::string::npos);
  std::string text = contents(folder_ / "out.txt");
  const std::size_t last = text.rfind('\n', text.size() - 2) + 1;
  write("less.txt", text.substr(0, last));
  refused(1, "verify all.txt less.txt", "points came out of");
  std::string wrong = text;
  wrong[wrong.size() - 2] = wrong[wrong.size() - 2] == '0' ? '1' : '0';  // changes the outlier flag of the last point
  write("wrong.txt", wrong);
  refused(1, "verify all.txt wrong.txt", "outlier");
  made("run all.txt kept.txt --pipeline 'sor | where(outlier == 0)' -q");
  EXPECT_EQ(tool("verify all.txt kept.txt").status, 0);
}

/// The rest of the output is checked, and the sentence names the attribute that is not.
TEST_F(SelectStages, VerifySaysWhatNeedsMoreMemoryThanItMayUse) {
  write_rows("all.txt", [](int) { return true; });
  const std::string pipeline =
      "--pipeline 'knn(radius=2) | dbscan(eps=2) | normals | ground(cell=2, window=8) | segments | components'";
  made("run all.txt out.txt -f -q " + pipeline, "out.txt");
  const Result whole = tool("verify all.txt out.txt " + pipeline);
  EXPECT_EQ(whole.status, 0) << whole.out << whole.err;
  EXPECT_EQ(whole.out.find("not checked"), std::string::npos) << whole.out;
  const Result little = tool("verify all.txt out.txt --memory 10k --sample 100 " + pipeline);
  EXPECT_EQ(little.status, 3) << little.out << little.err;
  for (const char* names :
       {"cluster cluster_size", "segment segment_size segment_residual", "component component_size"})
    EXPECT_NE(little.out.find(std::string("not checked        ") + names + ": that they are apart and in order needs "),
              std::string::npos)
        << little.out;
  EXPECT_NE(little.out.find("not checked        classification: its raster has "), std::string::npos) << little.out;
  EXPECT_NE(
      little.out.find("0 wrong: core cluster cluster_size normal segment segment_size segment_residual component"),
      std::string::npos)
      << little.out;
  made("run all.txt out.txt -f -q --order sweep --pipeline 'ground | height'", "out.txt");
  const Result swept = tool("verify out.txt --memory 10k");
  EXPECT_EQ(swept.status, 3) << swept.out << swept.err;
  EXPECT_NE(swept.out.find("not checked        height: needs --memory "), std::string::npos) << swept.out;
}

TEST_F(SelectStages, VerifyEvaluatesWhatReadsValuesOfAllPoints) {
  write_rows("all.txt", [](int) { return true; });
  const std::string pipeline =
      "knn(k=5) | components | set(level = 7 where component_size < 9) | ground(cell=2, window=8) | height | "
      "color(height, range=[0,3]) | set(level = 3 where height > 1)";
  made("run all.txt out.txt -f -q --pipeline '" + pipeline + "'", "out.txt");
  const Result sound = tool("verify out.txt");
  EXPECT_EQ(sound.status, 3) << "heights at the middle of two colours: " << sound.out << sound.err;
  EXPECT_TRUE(sound.out.ends_with("not checked: 9 of 5,400 values; all else is correct\n")) << sound.out;
  EXPECT_EQ(sound.out.find("not independent"), std::string::npos) << sound.out;
}

/// Points that are stored as text, as float32, as scaled integers, as tiles or as one file: equal rows stay.
TEST_F(SelectStages, ThinningKeepsTheSameRowsInEveryFormatAndTiling) {
  write_rows("all.txt", [](int) { return true; });
  write_rows("a.txt", [](int i) { return i < 300; });
  write_rows("b.txt", [](int i) { return i >= 300; });
  for (const char* thin :
       {"decimate(0.5)", "sample(300)", "voxel(2.57)", "decimate(0.9, seed=3) | voxel(3, keep=hash)", "poisson(1.9)"}) {
    SCOPED_TRACE(thin);
    const auto thinned = [&](const std::string& in, const std::string& out) {
      made(fmt::format("run {} -o {} -f -q --no-provenance --pipeline '{}'", in, out, thin), out);
      return made(fmt::format("run {} -o text.txt -f -q --no-provenance --keep x,y,z --pipeline 'where(x > -9)'", out),
                  "text.txt");
    };
    const std::string rows = thinned("all.txt", "out.txt");
    EXPECT_LT(std::count(rows.begin(), rows.end(), '\n'), 850);
    EXPECT_EQ(thinned("a.txt b.txt", "out.ply"), rows);
    EXPECT_EQ(tool("verify a.txt b.txt out.ply --pipeline '" + std::string(thin) + "'").status, 0);
    // The last bit of a coordinate in a LAS file may differ. It changes the hash of a point, and may move the point
    // over a face of a voxel.
    made("run all.txt all.las -f -q --pipeline 'unique'", "all.las");
    const std::string of_las = thinned("all.las", "out.las");
    const bool by_hash = std::string(thin) != "voxel(2.57)";
    EXPECT_TRUE(by_hash || points_in("out.las") == points_in("out.ply"));
    made("run all.las all.ply -f -q --no-provenance --pipeline 'unique'", "all.ply");
    EXPECT_EQ(thinned("all.ply", "out.las"), of_las);
  }
}

TEST_F(SelectStages, VerifyFindsAWrongRowOfAThinning) {
  write_rows("all.txt", [](int) { return true; });
  for (const char* thin : {"decimate(0.5)", "sample(300)", "sample(300, rest=yes, seed=2)", "voxel(2.5)",
                           "voxel(2.5, keep=hash)", "poisson(2)"}) {
    made(fmt::format("run all.txt out.txt -f -q --no-provenance --pipeline '{}'", thin), "out.txt");
    const Result sound = tool(fmt::format("verify all.txt out.txt --pipeline '{}'", thin));
    EXPECT_EQ(sound.status, 0) << sound.out << sound.err;
    std::string text = contents(folder_ / "out.txt");
    const std::size_t last = text.rfind('\n', text.size() - 2) + 1;
    write("wrong.txt", text.substr(0, last) + "0 0 50 3\n");
    EXPECT_EQ(tool(fmt::format("verify all.txt wrong.txt --pipeline '{}'", thin)).status, 1) << thin;
  }
  made("run all.txt out.txt -f -q --no-provenance --pipeline 'poisson(2, radius_from=level)'", "out.txt");
  refused(2, "verify all.txt out.txt --pipeline 'poisson(2, radius_from=level)'", "is not checked");
}

TEST_F(SelectStages, VerifyRefusesAThinningBehindOtherStagesAndChecksWhatStandsBeforeIt) {
  write_rows("all.txt", [](int) { return true; });
  for (const char* behind : {"normals | unique", "normals | voxel(1)", "where(level > 1) | normals | unique"}) {
    made(fmt::format("run all.txt out.txt -f -q --pipeline '{}'", behind), "out.txt");
    refused(2, "verify all.txt out.txt", "leaves out rows after other stages, and a sample of the input does not tell");
    refused(2, fmt::format("verify all.txt out.txt --pipeline '{}'", behind), "of the stages before it");
  }
  for (const char* before : {"normals", "where(level > 1) | normals", "unique | where(level > 1) | normals | sor"}) {
    made(fmt::format("run all.txt out.txt -f -q --pipeline '{}'", before), "out.txt");
    EXPECT_EQ(tool("verify all.txt out.txt").status, 0) << before;
  }
  // verify finds a row that should not be there.
  made("run all.txt out.txt -f -q --no-provenance --pipeline 'where(level > 1)'", "out.txt");
  refused(1, "verify all.txt out.txt --pipeline 'where(level > 2)'", "points came out of");
}

TEST_F(SelectStages, MistakesNameTheirPlace) {
  write_rows("all.txt", [](int) { return true; });
  refused(2, "run all.txt o.txt --pipeline 'where(level = 3)'", "column 7: '=' compares nothing; write ==.");
  refused(2, "run all.txt o.txt --pipeline 'where(lvel == 3)'",
          "there is no attribute 'lvel'; there are x, y, z, level");
  refused(2, "run all.txt o.txt --pipeline 'where(level == 3'", "column");
  refused(2, "run all.txt o.txt --pipeline 'where'", "'condition' is missing");
  refused(2, "run all.txt o.txt --pipeline 'sor(multiplier=-1)'", "0 or more");
  EXPECT_FALSE(exists("o.txt"));
}

}  // namespace
}  // namespace pointsweep
