// SPDX-License-Identifier: MIT
/// The operator take with files of all kinds, folders, budgets and resumed runs.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

using testing::HasSubstr;

class TakeOfFiles : public Tool {
 protected:
  void SetUp() override {
    made("generate terrain whole.las -n 30000 --quiet");
    made(
        "run whole.las few.las --quiet --pipeline 'voxel(20) | set(classification = 2 where z < 8) | "
        "set(tree_id = floor(x) + 1000 * floor(y), as=uint32) | set(z_of = z)'");
  }
  static constexpr const char* kRun = "run whole.las out.las --force --quiet --no-provenance --pipeline ";
  static constexpr const char* kLabels = "take(few.las, attributes=[classification, tree_id], k=5)";
};

TEST_F(TakeOfFiles, IsTheSameInAllWaysToRun) {
  for (const std::string& pipeline :
       {std::string(kLabels), std::string("take(few.las, attributes=[z_of, tree_id], most=15, missing=-1, vote=mean)"),
        std::string("normals | take(few.las, attributes=tree_id) | where(tree_id > 400000)")}) {
    const std::string run = kRun + ("'" + pipeline + "' "), right = made(run, "out.las");
    for (const char* options :
         {"--threads 1", "--memory 120M", "--axis y", "--resume done --checkpoint-seconds 0", "--threads 5"})
      EXPECT_TRUE(made(run + options, "out.las") == right) << pipeline << options;
  }
}

TEST_F(TakeOfFiles, TilesHaveTheLabelsOfTheMergedCloudAndTheOtherMayBeTiles) {
  std::filesystem::create_directory(folder_ / "in");
  std::filesystem::create_directory(folder_ / "few");
  made("run whole.las in/a.las --pipeline 'where(x < 300)' --no-provenance");
  made("run whole.las in/b.las --pipeline 'where(x >= 300)' --no-provenance");
  made("run few.las few/a.las --pipeline 'where(y < 500)' --no-provenance");
  made("run few.las few/b.laz --pipeline 'where(y >= 500)' --no-provenance");
  const std::string tiles = "'take(few/, attributes=[classification, tree_id], k=5)' --no-provenance";
  made("run in/ out/ --pipeline " + tiles);
  made("run in/ merged.las --pipeline '" + std::string(kLabels) + "' --no-provenance");
  made("sort out/ tiles.csv --axis x --no-provenance");
  made("sort merged.las merged.csv --axis x --no-provenance");
  EXPECT_TRUE(contents(folder_ / "tiles.csv") == contents(folder_ / "merged.csv"));
}

TEST_F(TakeOfFiles, PointsThatWereKeptHaveTheirOwnLabelsAgain) {
  made("run whole.las labelled.las --pipeline 'take(few.las, attributes=[classification, tree_id])'");
  made(
      "run few.las back.las --pipeline 'set(classification = 0, tree_id = 0) | take(labelled.las, "
      "attributes=[classification, tree_id])' --no-provenance");
  made("run few.las same.las --no-provenance");
  made("sort back.las back.csv --axis x --no-provenance");
  made("sort same.las same.csv --axis x --no-provenance");
  EXPECT_TRUE(contents(folder_ / "back.csv") == contents(folder_ / "same.csv"));
}

TEST_F(TakeOfFiles, ColoursOfPhotogrammetryGetTheBitsOfLas) {
  write("photo.csv", "x,y,z,red,green,blue\n0,0,0,255,0,16\n1000,1000,0,1,2,3\n");
  made("run photo.csv photo.ply --quiet --pipeline 'drop(red, green, blue) | color(x, map=gray)'");
  made("run whole.las out.las --quiet --pipeline 'take(photo.ply, attributes=[red, green, blue])'");
  EXPECT_THAT(made("info out.las", ".out"), HasSubstr("65535"));
  EXPECT_EQ(tool("verify out.las").status, 0);
}

TEST_F(TakeOfFiles, IsRefusedBeforeTheWork) {
  const std::string run = "run whole.las out.las --pipeline ";
  const auto taking = [&](const std::string& options) { return run + "'take(" + options + ")'"; };
  for (const char* dry : {"", " --dry-run"}) {
    refused(1, taking("gone.las, attributes=tree_id") + dry, "gone.las: no such file");
    refused(2, taking("few.las, attributes=tree") + dry,
            "few.las has no attribute 'tree'; the nearest it has are 'tree_id'");
    refused(2, taking("few.las, attributes=tree_id, most=5") + dry, "give missing=NUMBER");
    refused(2, taking("few.las, attributes=[tree_id, x]") + dry, "'x' is a coordinate");
  }
  refused(2, taking("few.las"), "attributes=classification");
  refused(2, taking(""), "take(labelled.las)");
  refused(2, taking("few.las, attributes=tree_id, k=1001"), "k is a whole number, 1 to 1000");
  refused(2, taking("few.las, attributes=tree_id, vote=median"), "vote is majority, mean or nearest");
  refused(2, "run whole.las few.las --force --pipeline 'take(few.las, attributes=tree_id)'", "few.las: is an input");
  write("nowhere.csv", "x,y,z,label\nnan,0,0,1\n");
  refused(1, taking("nowhere.csv, attributes=label"), "no point with a finite place");
  write("wide.csv", "x,y,z,classification\n0,0,0,300\n");
  refused(1, taking("wide.csv, attributes=classification"), "row 0: 'classification' would be 300, which is not uint8");
  EXPECT_FALSE(exists("out.las"));
  EXPECT_THAT(made(taking("few.las, attributes=[classification, tree_id]") + " --dry-run", ".out"),
              HasSubstr("other cloud   few.las, "));
}

TEST_F(TakeOfFiles, AnotherCoordinateSystemIsRefused) {
  const auto ply = [&](const std::string& name, const std::string& zone) {
    write(name, "ply\nformat ascii 1.0\ncomment crs PROJCS[\"WGS 84 / UTM zone " + zone +
                    "N\",AUTHORITY[\"EPSG\",\"326" + zone +
                    "\"]]\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\n"
                    "property uchar label\nend_header\n0 0 0 7\n");
  };
  ply("32.ply", "32");
  ply("33.ply", "33");
  const std::string run = "run 32.ply out.ply --force --pipeline 'drop(label) | take(33.ply, attributes=label)'";
  refused(2, run, "--ignore-crs");
  made(run + " --ignore-crs");
}

TEST_F(TakeOfFiles, AResumedRunKnowsTheOtherCloud) {
  const std::string run =
      "run whole.las out.las --pipeline 'take(few.las, attributes=[tree_id, z_of, classification])' --resume done "
      "--quiet ";
  // The run stops because the output has no room. The folder of checkpoints stays.
  const Result stopped = tool_under("ulimit -f 2900 && exec", run + "--checkpoint-seconds 0");
  ASSERT_NE(stopped.status, 0);
  ASSERT_TRUE(exists("done")) << stopped.err;
  made("run few.las few2.las --quiet --pipeline 'set(tree_id = 5)'");
  std::filesystem::rename(folder_ / "few2.las", folder_ / "few.las");
  refused(1, run, "other cloud");
  EXPECT_FALSE(exists("out.las"));
}

}  // namespace
}  // namespace pointsweep
