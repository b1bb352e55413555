// SPDX-License-Identifier: MIT
/// The operator level on clouds with more than one level; the clouds of tests/laws are too small for that. verify
/// evaluates the definition, with its own cube, order of points and search.
#include <algorithm>
#include <map>
#include <sstream>
#include <vector>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class LevelStage : public Tool {
 protected:
  LevelStage() {
    made("generate tls tls.ply -n 200000");
    write("nowhere.txt", "x y z\nnan 1 1\n2 inf 2\n");
  }
  /// Returns the lines "x,y,z,level" of files, sorted.
  std::vector<std::string> levels_of(const std::string& files) {
    std::istringstream text(made("convert " + files + " text.csv --force --keep x,y,z,level", "text.csv"));
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) lines.push_back(line);
    std::ranges::sort(lines);
    return lines;
  }
  std::vector<std::string> levels_by(const std::string& inputs, const std::string& options) {
    made("run " + inputs + " out.ply --pipeline level --force --keep level " + options);
    return levels_of("out.ply");
  }
};

TEST_F(LevelStage, IsItsDefinition) {
  made("run tls.ply nowhere.txt out.ply --pipeline level");
  EXPECT_EQ(tool("verify tls.ply nowhere.txt out.ply").status, 0);
  std::map<std::string, std::size_t> counts;
  for (const std::string& line : levels_of("out.ply")) ++counts[line.substr(line.rfind(',') + 1)];
  EXPECT_EQ(counts["255"], 2u) << "points without a place";
  EXPECT_GT(counts["0"], 1000u);
  EXPECT_LE(counts["0"], 100'000u);
  EXPECT_GT(counts["1"], counts["0"]);
  EXPECT_GT(counts.size(), 4u) << "levels";
}

TEST_F(LevelStage, IsTheSameForAnyAxisThreadsMemoryOrderTilesAndResumedRuns) {
  const std::vector<std::string> expected = levels_by("tls.ply", "--threads 1");
  EXPECT_GT(expected.size(), 200'000u);
  for (const std::string options :
       {"--axis x", "--axis z --threads 3", "--memory 90M", "--order sweep", "--resume kept"})
    EXPECT_TRUE(levels_by("tls.ply", options) == expected) << options;
  made("sort tls.ply sorted.ply --axis z");
  EXPECT_TRUE(levels_by("sorted.ply", "") == expected);
  made("tile tls.ply tiles/ --size 40");
  EXPECT_TRUE(levels_by("tiles/", "") == expected);
  made("run tiles/ levels/ --pipeline level --keep level");
  EXPECT_TRUE(levels_of("levels/") == expected) << "an output for each tile";
}

TEST_F(LevelStage, RefusesLengthsWithoutSquares) {
  write("far.txt", "x y z\n-1.7e308 0 0\n1.7e308 0 0\n1.7e308 0 1\n");
  refused(1, "run far.txt far.csv --pipeline level", "cannot hold squares of such distances");
  write("near.txt", "x y z\n0 0 0\n5e-324 0 0\n0 1e-310 0\n");
  refused(1, "run near.txt near.csv --pipeline level", "cannot hold squares of such distances");
}

TEST_F(LevelStage, StagesAfterAMoveRefuseLengthsWithoutSquares) {
  write("in.txt", "x y z\n0 0 0\n1 0 0\n1 1 0\n0 1 1\n");
  for (const char* factor : {"1e200", "1e-200"})
    refused(1,
            std::string("run in.txt out.csv --pipeline 'set(x = x * ") + factor +
                ", y = 0, z = 0) | reneighbor(k=2) | normals'",
            "cannot hold squares of such distances");
}

}  // namespace
}  // namespace pointsweep
