// SPDX-License-Identifier: MIT
/// `pointsweep convert` and `pointsweep denoise`, and what verify knows about their outputs.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class ConvertVerb : public Tool {
 protected:
  void SetUp() override { made("generate terrain in.las -n 3000 --noise 0.01 --outliers 0.01 -q"); }

  /// Returns the rows of the file as text, with all attributes.
  std::string rows_of(const std::string& file) {
    made("convert " + file + " rows.csv -q -f");
    return contents(folder_ / "rows.csv");
  }
};

TEST_F(ConvertVerb, KeepsEveryRowInItsOrderWithAllAttributesThroughEveryFormat) {
  const std::string rows = rows_of("in.las");
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 3001);
  made("convert in.las a.laz -q");
  EXPECT_TRUE(rows_of("a.laz") == rows);
  for (const char* format : {"ply", "pcd", "las"}) {
    made(fmt::format("convert a.laz b.{} -q -f", format));
    made(fmt::format("convert b.{} c.laz -q -f", format));
    EXPECT_TRUE(rows_of("c.laz") == rows) << format;
    EXPECT_EQ(tool(fmt::format("verify a.laz b.{}", format)).status, 0) << format;
  }
  EXPECT_TRUE(made("run in.las r.ply -q", "r.ply") == made("convert in.las r2.ply -q", "r2.ply"));
}

TEST_F(ConvertVerb, LazOfItsOwnTextIsHardlyLargerThanTheFileWas) {
  for (const char* scale : {"0.001", "0.01", "0.00025"}) {
    made(fmt::format("run in.las grid.laz -q -f --scale {} --pipeline 'drop(nx, ny, nz)'", scale));
    made("convert grid.laz own.csv -q -f");
    made("convert own.csv again.laz -q -f");
    EXPECT_EQ(tool("verify grid.laz again.laz").status, 0) << scale;
    EXPECT_LE(20 * contents(folder_ / "again.laz").size(), 21 * contents(folder_ / "grid.laz").size()) << scale;
  }
}

TEST_F(ConvertVerb, AnInputIsNeverItsOutput) {
  for (const char* force : {"", " -f"}) refused(2, std::string("convert in.las in.las") + force, "in.las: is an input");
}

TEST_F(ConvertVerb, PutsInputsOneAfterAnotherAndAFolderIntoAFolder) {
  made("convert in.las in.las both.csv -q --keep x,y,z");
  made("convert in.las one.csv -q --keep x,y,z");
  const std::string one = contents(folder_ / "one.csv"), points = one.substr(one.find('\n') + 1);
  EXPECT_TRUE(contents(folder_ / "both.csv") == one + points);
  std::filesystem::create_directory(folder_ / "tiles");
  std::filesystem::create_directory(folder_ / "out");
  made("convert in.las tiles/1.laz -q");
  made("convert in.las tiles/2.laz -q");
  made("convert tiles out/ -q --output-format ply");
  made("convert out/2.ply again.laz -q");
  EXPECT_TRUE(rows_of("again.laz") == rows_of("in.las"));
  EXPECT_EQ(tool("verify tiles out").status, 0);
}

TEST_F(ConvertVerb, TakesLittleMemoryAndAFolderForCheckpoints) {
  const std::string rows = rows_of("in.las");
  for (const char* options : {"--memory 32M --threads 1", "--memory 32M --threads 7", "--resume kept"}) {
    made(fmt::format("convert in.las a.laz -q -f {}", options));
    EXPECT_TRUE(rows_of("a.laz") == rows) << options;
  }
  const Result plan = tool("convert in.las a.ply --dry-run");
  EXPECT_NE(plan.out.find("no neighbours are searched"), std::string::npos) << plan.out;
  EXPECT_NE(plan.out.find("24.0 MB expected"), std::string::npos) << plan.out;
}

TEST_F(ConvertVerb, KeepsRowsWithoutAPlaceAndNoRowsAtAll) {
  write("odd.csv", "x,y,z,a\n1,2,3,4\nnan,2,3,5\n7,8,inf,6\n");
  made("convert odd.csv odd.ply -q");
  made("convert odd.ply back.csv -q");
  EXPECT_TRUE(contents(folder_ / "back.csv") == contents(folder_ / "odd.csv"));
  made("run odd.csv none.ply -q --pipeline 'where(a > 9)'");
  refused(1, "convert none.ply none.laz", "has no points");
}

TEST_F(ConvertVerb, InTheOrderOfTheSweepItIsASort) {
  made("convert in.las a.csv -q --order sweep");
  made("sort in.las b.csv -q");
  EXPECT_TRUE(contents(folder_ / "a.csv") == contents(folder_ / "b.csv"));
}

TEST_F(ConvertVerb, VerifyKnowsWhatConversionsAndSortsKeep) {
  for (const char* verb : {"convert", "sort"}) {
    made(fmt::format("{} in.las a.ply -q -f --keep x,y,z,intensity", verb));
    EXPECT_EQ(tool("verify a.ply").status, 0) << verb;
    made(fmt::format("{} in.las a.ply -q -f", verb));
    EXPECT_EQ(tool("verify a.ply").status, 0) << verb;
  }
  made("convert in.las a.csv -q --keep x,y,z");
  EXPECT_EQ(tool("verify in.las a.csv --keep x,y,z").status, 0);
  EXPECT_EQ(tool("verify in.las a.csv").status, 1) << "an attribute is missing that nobody left out";
}

TEST_F(ConvertVerb, DenoiseIsSorWithoutItsAttributes) {
  EXPECT_EQ(made("denoise in.las a.csv -q -k 9 --multiplier 1", "a.csv"),
            made("run in.las b.csv -q --pipeline 'knn(k=9) | sor(multiplier=1) | where(outlier == 0) | "
                 "drop(mean_distance, outlier)'",
                 "b.csv"));
  const std::string all = rows_of("in.las"), clean = contents(folder_ / "a.csv");
  EXPECT_LT(clean.size(), all.size());
  EXPECT_EQ(clean.substr(0, clean.find('\n')), all.substr(0, all.find('\n')));
  made("run in.las marked.las -q --pipeline 'set(outlier = 3)'");
  refused(2, "denoise marked.las b.las", "denoise: there is an attribute 'outlier', which the stage makes for itself");
  made("denoise in.las a.laz -q");
  EXPECT_EQ(tool("verify a.laz").status, 0);
}

}  // namespace
}  // namespace pointsweep
