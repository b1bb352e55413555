// SPDX-License-Identifier: MIT
/// The commands of docs/cookbook.md run.
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

/// The lines of the blocks that begin with ```sh.
std::vector<std::string> commands_of(const std::string& page) {
  std::vector<std::string> commands;
  std::istringstream lines(page);
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```"))
      inside = line == "```sh";
    else if (inside)
      commands.push_back(line);
  }
  return commands;
}

class Cookbook : public Tool {};

TEST_F(Cookbook, EveryCommandRuns) {
  std::filesystem::create_directory(folder_ / "tiles");
  const Result first = tool("generate terrain scan.laz -n 20000 --noise 0.05");
  if (first.err.find("built without") != std::string::npos) GTEST_SKIP() << first.err;
  ASSERT_EQ(first.status, 0) << first.err;
  made("run scan.laz tiles/west.laz --pipeline 'where(x < 500)'");
  made("run scan.laz tiles/east.laz --pipeline 'where(x >= 500)'");
  made("sort scan.laz before.laz");
  made("generate terrain after.laz -n 20000 --noise 0.05 --seed 2");
  write("site.geojson", R"({"type": "Polygon", "coordinates": [[[100, 100], [700, 100], [400, 800], [100, 100]]]})");
  const std::vector<std::string> commands = commands_of(contents(POINTSWEEP_SOURCE_DIR "/docs/cookbook.md"));
  EXPECT_GE(commands.size(), 20u);
  for (const std::string& command : commands) {
    ASSERT_TRUE(command.starts_with("pointsweep ")) << command;
    const Result result = tool(command.substr(11));
    EXPECT_EQ(result.status, 0) << command << "\n" << result.err;
  }
}

}  // namespace
}  // namespace pointsweep
