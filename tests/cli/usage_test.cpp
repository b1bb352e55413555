// SPDX-License-Identifier: MIT
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

using Usage = Tool;

constexpr const char* kVerbs[] = {"normals", "neighbors", "sort", "curvature", "splats", "fair",
                                  "run",     "operators", "info", "generate",  "render"};

TEST_F(Usage, HelpNamesEveryVerb) {
  const Result result = tool("--help");
  EXPECT_EQ(result.status, 0);
  for (const std::string verb : kVerbs)
    EXPECT_NE(result.out.find("\n  " + verb + " "), std::string::npos) << result.out;
}

TEST_F(Usage, HelpOfEveryVerbEndsWithAnExample) {
  for (const std::string verb : kVerbs) {
    const Result result = tool(verb + " --help");
    EXPECT_EQ(result.status, 0);
    const auto example = result.out.find("\nExample");
    ASSERT_NE(example, std::string::npos) << verb;
    EXPECT_NE(result.out.find("\n  pointsweep " + verb + " ", example), std::string::npos) << result.out;
  }
}

TEST_F(Usage, TheVersionIsOneLine) {
  const Result result = tool("--version");
  EXPECT_EQ(result.status, 0);
  EXPECT_TRUE(result.out.starts_with("pointsweep ")) << result.out;
  EXPECT_EQ(result.out.find('\n'), result.out.size() - 1);
}

TEST_F(Usage, NonsenseIsStatus2) {
  refused(2, "", "required");
  refused(2, "norml a b", "'norml' is not a verb");
  refused(2, "normals a.ply", "IN... OUT");
  refused(2, "sort", "IN... OUT");
  refused(2, "normals a.ply b.ply --colour", "--colour");
  refused(2, "sort a.ply b.ply --axis w", "'w' is not auto, x, y or z");
  refused(2, "normals a.ply b.ply --order random", "'random' is not input or sweep");
  refused(2, "normals a.ply b.ply --memory lots", "'lots' is not a size");
  refused(2, "normals a.ply b.ply --orient sideways", "'sideways'");
  refused(2, "normals a.ply b.ply --orient viewpoint 1,2", "X,Y,Z");
  refused(2, "normals a.ply b.ply -k -1", "'-1' is not a whole number");
}

TEST_F(Usage, AMissingInputIsStatus1) {
  refused(1, "normals a.ply b.ply", "a.ply");
  refused(1, "sort a.ply b.ply", "a.ply");
  refused(1, "neighbors a.ply b.npy", "a.ply");
}

TEST_F(Usage, StandardOutputThatIsFullIsAnError) {
  write("a.xyz", "0 0 0\n");
  const Result result = tool("info a.xyz 2>.err >/dev/full #");
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("standard output"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace pointsweep
