// SPDX-License-Identifier: MIT
/// The operators distance_to and m3c2 with files of all kinds, folders, budgets and resumed runs.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

using testing::HasSubstr;

class ChangeOfFiles : public Tool {
 protected:
  void SetUp() override {
    made("generate terrain before.las -n 30000 --quiet");
    made("generate terrain after.las -n 30000 --seed 7 --noise 0.05 --quiet");
  }
  static constexpr const char* kDistances = "run before.las out.las --force --quiet --no-provenance --pipeline ";
};

/// The terrain lies in the middle of the sphere, so all points of the sphere are almost equally far from it. Such
/// places are searched in groups.
TEST_F(ChangeOfFiles, IsTheSameInAllWaysToRun) {
  std::string sphere;
  for (int i = 0; i < 20'000; ++i) {
    const double angle = i * 2.399963229728653, z = (i + 0.5) / 10'000 - 1, r = std::sqrt(1 - z * z);
    sphere += fmt::format("{} {} {}\n", 1e5 * r * std::cos(angle), 1e5 * r * std::sin(angle), 1e5 * z);
  }
  write("sphere.xyz", sphere);
  for (const std::string pipeline : {"'distance_to(after.las)'", "'distance_to(sphere.xyz)'",
                                     "'knn(k=8) | normals | m3c2(after.las, cylinder=30, depth=5)'"}) {
    const std::string right = made(kDistances + pipeline, "out.las");
    for (const char* options : {"--threads 1", "--memory 80M", "--axis y", "--resume done --checkpoint-seconds 0"})
      EXPECT_TRUE(made(kDistances + pipeline + " " + options, "out.las") == right) << pipeline << options;
  }
}

TEST_F(ChangeOfFiles, TheOtherCloudMayBeAFolderOfTilesAPatternOrAnotherFormat) {
  const std::string right = made(std::string(kDistances) + "'distance_to(after.las)'", "out.las");
  std::filesystem::create_directory(folder_ / "tiles");
  made("run after.las tiles/a.las --pipeline 'where(x < 300)' --no-provenance");
  made("run after.las tiles/b.laz --pipeline 'where(x >= 300)' --no-provenance");
  for (const char* other : {"tiles", "tiles/*.la?", "tiles/"})
    EXPECT_TRUE(made(std::string(kDistances) + "'distance_to(\"" + other + "\")'", "out.las") == right) << other;
}

TEST_F(ChangeOfFiles, TilesHaveTheDistancesOfTheMergedCloud) {
  std::filesystem::create_directory(folder_ / "in");
  made("run before.las in/a.las --pipeline 'where(x < 300)' --no-provenance");
  made("run before.las in/b.las --pipeline 'where(x >= 300)' --no-provenance");
  made("run in/ out/ --pipeline 'distance_to(after.las)' --no-provenance");
  made("run in/ merged.las --pipeline 'distance_to(after.las)' --no-provenance");
  made("sort out/ tiles.csv --axis x --no-provenance");
  made("sort merged.las merged.csv --axis x --no-provenance");
  EXPECT_TRUE(contents(folder_ / "tiles.csv") == contents(folder_ / "merged.csv"));
}

TEST_F(ChangeOfFiles, SweepOrderChangesTheOrderOfRowsAlone) {
  made("run before.las rows.las --pipeline 'distance_to(after.las)' --no-provenance");
  made("run before.las swept.las --pipeline 'distance_to(after.las)' --order sweep --memory 80M --no-provenance");
  made("sort rows.las rows.csv --axis x --no-provenance");
  made("sort swept.las swept.csv --axis x --no-provenance");
  EXPECT_TRUE(contents(folder_ / "rows.csv") == contents(folder_ / "swept.csv"));
}

TEST_F(ChangeOfFiles, AnotherCoordinateSystemIsRefused) {
  const auto ply = [&](const std::string& name, const std::string& crs) {
    write(name, "ply\nformat ascii 1.0\ncomment crs " + crs +
                    "\nelement vertex 2\nproperty double x\nproperty double y\nproperty double z\nend_header\n"
                    "0 0 0\n1 0 0\n");
  };
  ply("utm.ply", R"(PROJCS["WGS 84 / UTM zone 32N",AUTHORITY["EPSG","32632"]])");
  ply("utm33.ply", R"(PROJCS["WGS 84 / UTM zone 33N",AUTHORITY["EPSG","32633"]])");
  const std::string run = "run utm.ply out.ply --force --pipeline 'distance_to(utm33.ply)'";
  refused(2, run, "--ignore-crs");
  refused(2, run + " --dry-run", "--ignore-crs");
  made(run + " --ignore-crs");
  made("run utm.ply out.ply --force --pipeline 'distance_to(utm.ply)'");
}

TEST_F(ChangeOfFiles, IsRefusedBeforeTheWork) {
  refused(1, "run before.las out.las --pipeline 'distance_to(gone.las)'", "gone.las: no such file");
  refused(1, "run before.las out.las --dry-run --pipeline 'distance_to(gone.las)'", "gone.las: no such file");
  refused(2, "run before.las after.las --force --pipeline 'distance_to(after.las)'", "after.las: is an input");
  refused(2, "run before.las out.las --pipeline 'distance_to()'", "distance_to(before.las)");
  EXPECT_FALSE(exists("out.las"));
  EXPECT_THAT(made("run before.las out.las --dry-run --pipeline 'distance_to(after.las)'", ".out"),
              HasSubstr("other cloud   after.las, 30000 points"));
}

TEST_F(ChangeOfFiles, AResumedRunKnowsTheOtherCloud) {
  const std::string run = "run before.las out.las --pipeline 'distance_to(after.las)' --resume done --quiet ";
  // The run stops because the output has no room. The folder of checkpoints stays.
  const Result stopped = tool_under("ulimit -f 2900 && exec", run + "--checkpoint-seconds 0");
  ASSERT_NE(stopped.status, 0);
  ASSERT_TRUE(exists("done")) << stopped.err;
  ASSERT_THAT(stopped.err, HasSubstr("out.las"));
  made("generate terrain after.las -n 20000 --seed 8 --force --quiet");
  refused(1, run, "other cloud");
  EXPECT_FALSE(exists("out.las"));
}

}  // namespace
}  // namespace pointsweep
