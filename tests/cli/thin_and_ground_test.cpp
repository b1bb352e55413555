// SPDX-License-Identifier: MIT
/// The verbs thin and ground run the pipelines that their help names.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class ThinAndGround : public Tool {
 protected:
  ThinAndGround() {
    std::string text = "x y z\n";
    for (int i = 0; i < 900; ++i)
      text += fmt::format("{} {} {}\n", i % 30 * 0.5, i / 30 * 0.5, i % 7 == 0 ? 4 : i * 37 % 101 * 0.001);
    write("all.txt", text);
  }
  /// Expects that a verb writes the bytes that a pipeline writes.
  void expect_same(const std::string& verb, const std::string& pipeline) {
    const std::string common = " -f -q --no-provenance ";
    EXPECT_EQ(made(verb + " all.txt verb.ply" + common, "verb.ply"),
              made("run all.txt run.ply" + common + "--pipeline '" + pipeline + "'", "run.ply"))
        << verb;
  }
};

TEST_F(ThinAndGround, ThinIsVoxelPoissonOrDecimate) {
  expect_same("thin --voxel 1.3", "voxel(1.3)");
  expect_same("thin --voxel 1.3 --voxel-keep hash", "voxel(1.3, keep=hash)");
  expect_same("thin --voxel 1.3 --voxel-keep centroid", "voxel(1.3, keep=centroid)");
  expect_same("thin --poisson 1.1", "poisson(1.1)");
  expect_same("thin --radius-from z --poisson 3", "poisson(3, radius_from=z)");
  expect_same("thin --decimate 0.25", "decimate(0.25)");
  expect_same("thin --number 40", "sample(40)");
  expect_same("thin --number 40 --rest yes", "sample(40, rest=yes)");
  expect_same("thin --decimate 0.25 --seed 4", "decimate(0.25, seed=4)");
  expect_same("thin --number 50 --rest yes --seed 4", "sample(50, rest=yes, seed=4)");
}

TEST_F(ThinAndGround, TheOldNameOfVoxelKeepIsTakenWithANote) {
  const Result result = tool("thin all.txt old.ply --voxel 1.3 --choose hash --no-provenance");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("note: --choose is called --voxel-keep now"), std::string::npos) << result.err;
  EXPECT_EQ(contents(folder_ / "old.ply"),
            made("thin all.txt new.ply -q --voxel 1.3 --voxel-keep hash --no-provenance", "new.ply"));
  EXPECT_EQ(tool("help thin").out.find("--choose"), std::string::npos);
}

TEST_F(ThinAndGround, ThinRefusesWhatDoesNotGoTogether) {
  const char* how = "thin: give one of --voxel SIZE, --poisson RADIUS, --decimate SHARE and --number N";
  refused(2, "thin all.txt out.ply", how);
  refused(2, "thin all.txt out.ply --seed 3", how);
  refused(2, "thin all.txt out.ply --voxel 1 --poisson 2", how);
  refused(2, "thin all.txt out.ply --decimate 0.5 --rest yes", "--rest: belongs to --number; leave it out, or use");
  refused(2, "thin all.txt out.ply --voxel 1 --seed 3",
          "--seed: belongs to --decimate; leave it out, or use --decimate");
  refused(2, "thin all.txt out.ply --voxel 0", "--voxel: voxel: size is a number, above 0, not '0'");
  refused(2, "thin all.txt out.ply --decimate 2", "share is a number, 0 to 1, not '2'");
  refused(2, "thin all.txt out.ply --voxel 1 --orient up", "--orient");
  EXPECT_FALSE(exists("out.ply"));
}

TEST_F(ThinAndGround, GroundIsTheOperatorWithItsOptions) {
  expect_same("ground --cell 1 --window 4", "ground(cell=1, window=4)");
  expect_same("ground --cell 1 --window 4 --slope 0.3 --threshold 0.2 --scalar 2 --returns all --noise yes --height",
              "ground(cell=1, window=4, slope=0.3, threshold=0.2, scalar=2, returns=all, noise=yes) | height");
  expect_same("ground --height", "ground | height");
  refused(2, "ground all.txt out.ply --cell 0", "cell is a number, above 0, not '0'");
}

TEST_F(ThinAndGround, TilesGetTheirPartOfTheThinnedCloud) {
  std::filesystem::create_directory(folder_ / "tiles");
  const std::string text = contents(folder_ / "all.txt");
  const std::size_t middle = text.find('\n', text.size() / 2) + 1;
  write("tiles/a.txt", text.substr(0, middle)), write("tiles/b.txt", "x y z\n" + text.substr(middle));
  made("thin tiles/ out/ --voxel 1.25 -q --no-provenance");
  const std::string whole = made("thin all.txt whole.txt --voxel 1.25 -q --no-provenance", "whole.txt");
  const std::string second = contents(folder_ / "out/b.txt");
  EXPECT_EQ(contents(folder_ / "out/a.txt") + second.substr(second.find('\n') + 1), whole);
  EXPECT_EQ(tool("verify tiles/ out/ --pipeline 'voxel(1.25)'").status, 0);
  made("thin all.txt mean.txt --voxel 1.25 --voxel-keep centroid -q");
  EXPECT_EQ(tool("verify mean.txt").status, 0);
}

}  // namespace
}  // namespace pointsweep
