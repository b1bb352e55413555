// SPDX-License-Identifier: MIT
/// The verbs tile and split, and the options --tile and --split of other verbs, as a user runs them; verify of their
/// files.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

namespace fs = std::filesystem;

class Divided : public Tool {
 protected:
  Divided() { made("generate terrain all.las -n 3000 -q"); }

  std::set<std::string> names_in(const std::string& folder) const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_ / folder)) names.insert(entry.path().filename().string());
    return names;
  }
  void expect_verified(const std::string& arguments) {
    const Result result = tool("verify " + arguments);
    EXPECT_EQ(result.status, 0) << arguments << result.out << result.err;
    EXPECT_NE(result.out.find("OK: inputs unchanged"), std::string::npos) << result.out;
  }
};

TEST_F(Divided, TilesAreVerifiedInEveryFormat) {
  for (const char* format : {"las", "laz", "ply", "pcd"}) {
    made(fmt::format("tile all.las {0} --size 250 --output-format {0} -q", format));
    EXPECT_EQ(names_in(format).size(), 16u);
    EXPECT_TRUE(exists(fmt::format("{0}/250_750.{0}", format)));
    expect_verified(std::string("all.las ") + format);
    expect_verified(std::string(format) + "/");
  }
  made("tile all.las csv/ --size 250 --origin 100,50 --buffer 20 --output-format csv --decimals 1 -q");
  expect_verified("all.las csv --decimals 1 --tile 250 --tile-origin 100,50 --tile-buffer 20");
}

TEST_F(Divided, MergedTilesAreTheInputAgain) {
  made("tile all.las tiles/ --size 130 --buffer 25 -q --no-provenance");
  made("run tiles/ back.las -q --pipeline 'where(buffer == 0) | drop(buffer)' --no-provenance");
  made("convert all.las plain.las -q --no-provenance");
  EXPECT_EQ(tool("verify plain.las back.las --order sweep --axis x").status, 1) << "in another order";
  made("sort back.las back_sorted.las -q --no-provenance");
  made("sort plain.las plain_sorted.las -q --no-provenance");
  EXPECT_TRUE(contents(folder_ / "back_sorted.las") == contents(folder_ / "plain_sorted.las"));
}

TEST_F(Divided, TilesOfTilesAreTheSmallTiles) {
  made("tile all.las large --size 500 -q --no-provenance");
  made("tile large small --size 125 -q --no-provenance");
  made("tile all.las direct --size 125 -q --no-provenance");
  EXPECT_EQ(names_in("small"), names_in("direct"));
  for (const std::string& name : names_in("direct"))
    EXPECT_TRUE(contents(folder_ / "small" / name) == contents(folder_ / "direct" / name)) << name;
}

TEST_F(Divided, OneRunComputesAndDivides) {
  made(
      "run all.las out -q --tile 300 --tile-buffer 10 --pipeline 'knn(k=6) | where(x > 100) | sor | "
      "features(names=[linearity])'");
  expect_verified("all.las out");
  made("denoise all.las clean/ -q --tile 500");
  refused(2, "verify all.las clean", "nor by one that is divided among files");
  made("split all.las parts -q --parts 5 --seed 3");
  EXPECT_EQ(names_in("parts"),
            (std::set<std::string>{"part_0.las", "part_1.las", "part_2.las", "part_3.las", "part_4.las"}));
  expect_verified("all.las parts");
  made(
      "run all.las classes -q --pipeline 'set(classification = 2 where z < 0)' --split classification --output-format "
      "laz");
  EXPECT_EQ(names_in("classes"), (std::set<std::string>{"classification_0.laz", "classification_2.laz"}));
  expect_verified("all.las classes");
  made("split all.las 'named/north_*.csv' --by return_number -q");
  EXPECT_EQ(names_in("named"), std::set<std::string>{"north_return_number_1.csv"});
}

TEST_F(Divided, VerifyFindsAPointThatIsLostDoubledOrMisplaced) {
  made("convert all.las all.csv -q");
  made("tile all.csv tiles --size 250 -q");
  const std::string options = "all.csv tiles --tile 250";
  expect_verified(options);
  const std::string whole = contents(folder_ / "tiles/0_0.csv");
  const std::size_t line = whole.rfind('\n', whole.size() - 2) + 1;
  const std::string other = contents(folder_ / "tiles/250_0.csv");
  write("tiles/0_0.csv", whole.substr(0, line));
  refused(1, "verify " + options, "2999 points came out of 3000");
  write("tiles/0_0.csv", whole + whole.substr(line));
  refused(1, "verify " + options, "3001 points came out of 3000");
  write("tiles/0_0.csv", whole.substr(0, line));
  write("tiles/250_0.csv", other + whole.substr(line));
  refused(1, "verify " + options, "belongs into another file");
  write("tiles/250_0.csv", other);
  fs::rename(folder_ / "tiles/0_0.csv", folder_ / "tiles/5_5.csv");
  write("tiles/5_5.csv", whole);
  refused(1, "verify " + options, "is not named after its points");
  made("tile all.csv wide --size 250 --buffer 9 -q");
  expect_verified("all.csv wide --tile 250 --tile-buffer 9");
  refused(1, "verify all.csv wide --tile 250 --tile-buffer 10", "does not hold the points around its tile");
}

TEST_F(Divided, VerifyFindsAChangedValueOfAPointInABuffer) {
  made("convert all.las all.csv -q");
  made("tile all.csv wide --size 250 --buffer 9 -q");
  std::string tile = contents(folder_ / "wide/0_0.csv");
  std::size_t at = tile.rfind('\n', tile.find(",1\n"));  // the line of a point of the buffer
  for (int column = 0; column < 3; ++column) at = tile.find(',', at + 1);
  write("wide/0_0.csv", tile.insert(at + 1, "1"));
  refused(1, "verify all.csv wide --tile 250 --tile-buffer 9", "have other values than in their own tiles");
}

TEST_F(Divided, VerifyKnowsTheNamesOfTilesOfEveryPattern) {
  made("tile all.las 'tiles/a_*_x.laz' --size 250 -q");
  expect_verified("all.las tiles/");
  expect_verified("all.las 'tiles/a_*_x.laz'");
  fs::rename(folder_ / "tiles/a_0_0_x.laz", folder_ / "tiles/a_5_0_x.laz");
  refused(1, "verify all.las tiles/", "a_5_0_x.laz: is not named after its points");
  fs::rename(folder_ / "tiles/a_5_0_x.laz", folder_ / "tiles/b_0_0_x.laz");
  refused(1, "verify all.las tiles/", "b_0_0_x.laz: is not named after its points");
  refused(2, "verify all.las '*.las'", "are no tiles and no parts of one output");
  made("tile all.las copc/ --size 250 --output-format copc.laz -q");
  expect_verified("all.las copc/");
  made("split all.las 'parts/*_x.copc.laz' --by return_number -q");
  expect_verified("all.las parts/");
}

TEST_F(Divided, VerifyComparesMergedTilesWithTheInputInAnyOrder) {
  made("tile all.las tiles/ --size 130 -q");
  for (const char* options : {"", "--no-provenance"}) {
    made(fmt::format("convert tiles/ back.las -q -f {}", options));
    expect_verified("all.las back.las");
  }
  expect_verified("tiles/ back.las");
}

TEST_F(Divided, ThePlaceOfTheOutputIsCheckedFirst) {
  refused(2, "tile all.las out", "give the length of the edge of a tile, --size LENGTH");
  refused(2, "tile all.las out --size 0", "--size: '0' is not above 0");
  refused(2, "tile all.las out --size x", "--size: 'x' is not a number from 0 on");
  refused(2, "tile all.las out --size 5 --origin 1", "--origin: '1' is not X,Y, two numbers");
  refused(2, "tile all.las out.las --size 500", "out.las: is the name of one file, and many are written");
  refused(2, "tile all.las - --size 500", "many files are written; name a folder");
  refused(1, "tile all.las no/such/out --size 500", "does not exist; create it first");
  refused(2, "tile all.las 'out/*.las' --size 500 --output-format laz", "says the format");
  refused(2, "tile all.las out --size 500 --resume done", "cannot be resumed");
  refused(2, "tile all.las . --size 500 -f", "is in the folder of the outputs");
  refused(2, "split all.las out", "give one of --by ATTRIBUTE and --parts NUMBER");
  refused(2, "split all.las out --by classification --parts 2", "give one of");
  refused(2, "split all.las out --by classification --seed 2", "--seed: belongs to --parts");
  refused(2, "split all.las out --by z", "'z' has no whole numbers");
  refused(2, "split all.las out --by z", "run INPUT OUTPUT --pipeline 'set(part = floor(z), as=int32)' --split part.");
  made("run all.las of_z/ --pipeline 'set(part = floor(z), as=int32)' --split part");
  refused(2, "run all.las out --tile 5 --split classification", "make two runs");
  refused(2, "run all.las out.las --tile-buffer 5", "belong to --tile");
  EXPECT_FALSE(exists("out"));
  made("tile all.las out --size 500 -q");
  refused(1, "tile all.las out --size 250", "out: holds point files already");
  made("tile all.las out --size 500 -q -f");
  made("run all.las none -q --tile 500 --pipeline 'where(x < 0)'");
  EXPECT_FALSE(exists("none")) << "no point, no file";
  const Result plan = tool("tile all.las later --size 500 --dry-run");
  EXPECT_NE(plan.out.find("divided among files"), std::string::npos) << plan.out;
  EXPECT_FALSE(exists("later"));
}

TEST_F(Divided, PointsWithoutAPlaceHaveAFileOfTheirOwn) {
  write("gaps.txt", "x y z\n1 1 1\nnan 2 2\n3 inf 3\n4 4 nan\n");
  const Result result = tool("tile gaps.txt out --size 10");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("out/unplaced.txt: 2 points have no finite x and y, and are in no tile"), std::string::npos)
      << result.err;
  EXPECT_EQ(names_in("out"), (std::set<std::string>{"0_0.txt", "unplaced.txt"}));
  expect_verified("gaps.txt out");
}

TEST_F(Divided, StopsWithCompleteFilesOnlyWhereTheDiskIsFull) {
  made("generate terrain many.las -n 60000 -q");
  const Result stopped = tool_under("ulimit -f 1000 && exec", "tile many.las out --size 700 -q");
  EXPECT_EQ(stopped.status, 1) << stopped.err;
  const std::set<std::string> files = exists("out") ? names_in("out") : std::set<std::string>{};
  for (const std::string& name : files) EXPECT_EQ(tool("info out/" + name).status, 0) << name;
}

}  // namespace
}  // namespace pointsweep
