// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

/// Folders, patterns and virtual point clouds (.vpc) in the place of file names.
class FolderInputs : public Tool {
 protected:
  FolderInputs() {
    std::filesystem::create_directories(folder_ / "tiles/deep");
    made("generate statue tiles/b.ply -n 300 --seed 1");
    made("generate statue tiles/a.las -n 200 --seed 2");
    made("generate statue tiles/B.xyz -n 100 --seed 3");
    made("generate statue tiles/deep/c.ply -n 50 --seed 4");
    write("tiles/readme.txt", "These tiles are of a statue.\n");
    write("tiles/a.prj", "PROJCS[]");
    write("tiles/.hidden.ply", "ply\n");
  }
  std::uint64_t points_in(const std::string& name) {
    return nlohmann::json::parse(tool("info --json --no-spacing " + name).out)["all"]["points"];
  }
};

TEST_F(FolderInputs, AFolderIsItsPointFilesInTheOrderOfTheirBytes) {
  const std::string merged = made("sort tiles/B.xyz tiles/a.las tiles/b.ply named.ply --no-provenance", "named.ply");
  EXPECT_EQ(made("sort tiles folder.ply --no-provenance", "folder.ply"), merged);
  EXPECT_EQ(made("sort tiles/ slash.ply --no-provenance", "slash.ply"), merged);
  const std::string normals = made("normals tiles/B.xyz tiles/a.las tiles/b.ply nn.ply --no-provenance", "nn.ply");
  EXPECT_EQ(made("normals tiles nf.ply --no-provenance", "nf.ply"), normals);
}

TEST_F(FolderInputs, WhatIsNoPointFileIsLeftOutWithOneLine) {
  const Result run = tool("normals tiles out.ply");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("tiles: 2 files are no point files and are left out, the first tiles/a.prj."),
            std::string::npos)
      << run.err;
  EXPECT_EQ(run.err.find("hidden"), std::string::npos);
}

TEST_F(FolderInputs, RecursiveTakesTheFoldersInItButFollowsNoLinksToFolders) {
  std::filesystem::create_directory_symlink("..", folder_ / "tiles/deep/circle");
  made("normals tiles flat.ply");
  made("normals tiles all.ply --recursive");
  EXPECT_EQ(points_in("flat.ply"), 600u);
  EXPECT_EQ(points_in("all.ply"), 650u);
  EXPECT_EQ(points_in("tiles --recursive"), 650u);
}

TEST_F(FolderInputs, PatternsAreExpandedAlsoWithinFolders) {
  for (const auto& [pattern, points] : std::vector<std::pair<std::string, std::uint64_t>>{{"'tiles/*.ply'", 300},
                                                                                          {"'tiles/?.*'", 600},
                                                                                          {"'tiles/[a-b].*'", 500},
                                                                                          {"'tiles/**/*.ply'", 350},
                                                                                          {"'**/*.ply'", 350},
                                                                                          {"'t*/d*/*'", 50},
                                                                                          {"'tiles/d*/'", 50}})
    EXPECT_EQ(points_in(pattern), points) << pattern;
  EXPECT_EQ(made("sort 'tiles/*.[lp]?[sy]' pattern.ply --no-provenance", "pattern.ply"),
            made("sort tiles/a.las tiles/b.ply named.ply --no-provenance", "named.ply"));
}

TEST_F(FolderInputs, AFileWhoseNameLooksLikeAPatternIsItself) {
  made("generate statue 'a[1].ply' -n 20");
  EXPECT_EQ(points_in("'a[1].ply'"), 20u);
}

TEST_F(FolderInputs, AFolderWhoseNameLooksLikeAPatternIsItselfWithinAPattern) {
  for (const char* folder : {"scan [2]", "scan 2", "deep [ab]/a"})
    std::filesystem::create_directories(folder_ / folder);
  made("generate statue 'scan [2]/a.ply' -n 20");
  made("generate statue 'scan 2/a.ply' -n 30");
  made("generate statue 'deep [ab]/a/[c].ply' -n 40");
  EXPECT_EQ(points_in("'scan [2]/*.ply'"), 20u);
  EXPECT_EQ(points_in("'scan [2-3]/*.ply'"), 30u);
  EXPECT_EQ(points_in("'deep [ab]/?/*.ply'"), 40u);
  made("sort 'scan [2]/*.ply' sorted.ply");
  made("run 'deep [ab]/**/*.ply' out/ --pipeline 'decimate(1)'");
  EXPECT_TRUE(exists("out/a/[c].ply"));
}

TEST_F(FolderInputs, SeveralArgumentsOfAllKindsMayBeMixed) {
  made("generate statue more.ply -n 10");
  made("normals more.ply 'tiles/*.las' tiles/deep -o out.ply");
  EXPECT_EQ(points_in("out.ply"), 260u);
  made("neighbors tiles/deep more.ply -o out.npy");
  made("render tiles out.png");
}

TEST_F(FolderInputs, AFileThatIsListedTwiceIsRefused) {
  refused(2, "normals tiles tiles/b.ply -o out.ply", "tiles/b.ply: is listed twice");
  refused(2, "normals tiles/b.ply 'tiles/*.ply' -o out.ply", "tiles/b.ply: is listed twice");
  std::filesystem::create_symlink("b.ply", folder_ / "tiles/latest.ply");
  refused(2, "normals tiles out.ply", "are the same file");
  EXPECT_FALSE(exists("out.ply"));
}

TEST_F(FolderInputs, WhatStandsForNoFileIsRefusedWithARemedy) {
  std::filesystem::create_directories(folder_ / "none/deep");
  write("none/notes.md", "# Notes\n");
  refused(1, "normals none out.ply", "none: holds no point file; name another folder, or add --recursive");
  refused(1, "normals none out.ply --recursive", "none: holds no point file, nor do its folders");
  refused(1, "normals 'tiles/*.e57' out.ply", "tiles/*.e57: no file has a name of this pattern");
  refused(1, "normals 'none/*' out.ply", "no file of this pattern is a point file, the first is none/notes.md");
}

TEST_F(FolderInputs, DamagedTilesAreErrorsAndNotLeftOut) {
  write("tiles/broken.laz", "no LAZ at all");
  refused(1, "normals tiles out.ply", "tiles/broken.laz: ");
  write("tiles/broken.laz", "");
  refused(1, "normals tiles out.ply", "tiles/broken.laz: is empty");
}

TEST_F(FolderInputs, AnOutputAmongTheInputsIsRefused) {
  refused(2, "normals tiles tiles/b.ply --force", "tiles/b.ply: is an input");
  std::filesystem::create_hard_link(folder_ / "tiles/b.ply", folder_ / "link.ply");
  refused(2, "normals tiles link.ply --force", "is an input");
}

TEST_F(FolderInputs, ThereMayBeMoreFilesThanCanBeOpenAtOnce) {
  std::filesystem::create_directory(folder_ / "many");
  std::string named;
  for (int i = 0; i < 60; ++i) {
    const std::string name = "many/" + std::to_string(100 + i) + (i % 2 == 0 ? ".ply" : ".las");
    made("generate statue " + name + " -n 40 --seed " + std::to_string(i));
  }
  const std::string free = made("normals many free.ply -k 5 --no-provenance", "free.ply");
  const Result tight = tool_under("ulimit -n 24 && exec", "normals many tight.ply -k 5 --no-provenance");
  EXPECT_EQ(tight.status, 0) << tight.err;
  EXPECT_EQ(contents(folder_ / "tight.ply"), free);
  std::filesystem::rename(folder_ / "many/100.ply", folder_ / "first.ply");
  const Result piped = tool_under("(ulimit -n 24 && cat first.ply |", "normals - many piped.ply -k 5 --no-provenance)");
  EXPECT_EQ(piped.status, 0) << piped.err;
  EXPECT_EQ(contents(folder_ / "piped.ply"), free);
}

TEST_F(FolderInputs, VerifyTakesThemToo) {
  made("normals tiles out.ply --no-provenance");
  EXPECT_EQ(tool("verify tiles out.ply").status, 0);
  EXPECT_EQ(tool("verify 'tiles/*.*' out.ply").status, 0);
  EXPECT_EQ(tool("verify tiles/deep out.ply").status, 1);
}

TEST_F(FolderInputs, AVirtualPointCloudIsTheFilesThatItNames) {
  write("tiles/all.vpc", R"({"type": "FeatureCollection", "features": [
    {"type": "Feature", "stac_version": "1.0.0", "assets": {"data": {"href": "./b.ply", "roles": ["data"]}}},
    {"type": "Feature", "assets": {"overview": {"href": "./o.laz", "roles": ["overview"]},
                                   "points": {"href": "deep/c.ply", "roles": ["data"]}}}]})");
  EXPECT_EQ(made("sort tiles/all.vpc vpc.ply --no-provenance", "vpc.ply"),
            made("sort tiles/b.ply tiles/deep/c.ply named.ply --no-provenance", "named.ply"));
  const std::string absolute = (folder_ / "tiles/b.ply").string();
  write("absolute.vpc", R"({"type": "FeatureCollection", "features": [{"assets": {"data": {"href": "file://)" +
                            absolute + R"("}}}, {"assets": {"data": {"href": "tiles/a.las"}}}]})");
  EXPECT_EQ(points_in("absolute.vpc"), 500u);
}

TEST_F(FolderInputs, AVirtualPointCloudThatCannotBeFollowedSaysWhere) {
  const auto with = [&](const std::string& href) {
    write("v.vpc", R"({"type": "FeatureCollection", "features": [{"assets": {"data": {"href": ")" + href + R"("}}}]})");
  };
  with("tiles/gone.laz");
  refused(1, "normals v.vpc out.ply", "v.vpc: names tiles/gone.laz, which does not exist");
  with("https://127.0.0.1:1/a.copc.laz");
  refused(1, "normals v.vpc out.ply", "https://127.0.0.1:1/a.copc.laz: ");
  write("v.vpc", R"({"type": "FeatureCollection", "features": [{"assets": {}}]})");
  refused(1, "normals v.vpc out.ply", "v.vpc: feature 0 has no asset");
  write("v.vpc", R"({"type": "FeatureCollection", "features": []})");
  refused(1, "normals v.vpc out.ply", "v.vpc: names no point file");
  write("v.vpc", "[1, 2]");
  refused(1, "normals v.vpc out.ply", "v.vpc: is no JSON object");
  write("v.vpc", R"({"type": "Feature"})");
  refused(1, "normals v.vpc out.ply", "v.vpc: is no virtual point cloud");
  EXPECT_FALSE(exists("out.ply"));
}

TEST_F(FolderInputs, FilesWithoutASignatureAreInAFolderIfTheirFormatIsAskedFor) {
  std::filesystem::create_directory(folder_ / "velodyne");
  for (const char* name : {"velodyne/0.bin", "velodyne/1.bin"}) write(name, std::string(16 * 30, '\x3c'));
  refused(1, "normals velodyne out.ply", "velodyne: holds no point file");
  made("normals velodyne out.ply --format kitti");
  EXPECT_EQ(points_in("out.ply"), 60u);
  EXPECT_EQ(points_in("'velodyne/*' --format kitti"), 60u);
  refused(2, "normals velodyne out/ --format kitti", "files named *.bin are not written; choose a format");
  made("normals velodyne out/ --format kitti --output-format ply");
  EXPECT_EQ(points_in("out"), 60u);
}

TEST_F(FolderInputs, StandardInputMayBeOneOfThemAndHasNoPlaceInAFolderOfOutputs) {
  const std::string begin = "cd '" + folder_.string() + "' && " + program() + " ";
  EXPECT_EQ(std::system((begin + "normals tiles/deep - -o out.ply <tiles/b.ply 2>/dev/null").c_str()), 0);
  EXPECT_EQ(points_in("out.ply"), 350u);
  refused(2, "normals - out/", "standard input has no name for its output in a folder");
}

}  // namespace
}  // namespace pointsweep
