// SPDX-License-Identifier: MIT
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class Info : public Tool {
 protected:
  /// A PLY file of such points, and what the tool says of it.
  std::string info_of(const std::string& rows, int count) {
    write("a.ply", "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
                       "\nproperty float x\nproperty double y\nproperty double z\nproperty uchar red\nend_header\n" +
                       rows);
    const Result result = tool("info a.ply");
    EXPECT_EQ(result.status, 0) << result.err;
    return result.out;
  }
  static void says(const std::string& text, const std::string& line) {
    EXPECT_NE(("\n" + text).find("\n  " + line + "\n"), std::string::npos) << text << "does not say: " << line;
  }
};

TEST_F(Info, StatesFormatCountBoundsAndAttributes) {
  const std::string text = info_of("1 20 -3 7\n3 5 0.25 8\n2 6 100000.125 9\n", 3);
  says(text, "points      3");
  says(text, "x           1 .. 3");
  says(text, "y           5 .. 20");
  says(text, "z           -3 .. 100000.125");
  says(text, "attributes  x float32, y z float64, red uint8");
  EXPECT_TRUE(text.starts_with("a.ply\n  format      PLY")) << text;
}

TEST_F(Info, FindsTheOrderAlongEachAxis) {
  says(info_of("1 9 5 0\n1 8 7 0\n2 7 6 0\n", 3), "order       ascending along x, descending along y");
  says(info_of("1 1 5 0\n2 2 4 0\n3 3 5 0\n", 3), "order       ascending along x and y");
  says(info_of("1 2 1 0\n2 1 2 0\n1 2 1 0\n", 3), "order       none");
  says(info_of("5 5 1 0\n5 5 2 0\n", 2), "order       ascending along z");
}

TEST_F(Info, CountsPointsThatAreNotFiniteAndKeepsThemOutOfTheBounds) {
  const std::string text = info_of("1 1 1 0\nnan 9 9 0\n2 2 2 0\n3 inf 0 0\n", 4);
  says(text, "points      4");
  says(text, "not finite  2 points, not in the bounds");
  says(text, "y           1 .. 2");
  says(text, "order       ascending along x and y and z");
}

TEST_F(Info, AddsUpSeveralFiles) {
  write("a.xyz", "0 0 0\n1 1 1\n");
  write("b.xyz", "5 -1 0\n");
  const Result result = tool("info a.xyz b.xyz");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("all 2 files\n  points      3\n  x           0 .. 5\n  y           -1 .. 1\n"),
            std::string::npos)
      << result.out;
}

TEST_F(Info, KnowsASortedFileFromAGeneratedOne) {
  ASSERT_EQ(tool("generate statue a.ply -n 5000").status, 0);
  says(tool("info a.ply").out, "order       none");
  ASSERT_EQ(tool("sort a.ply b.ply --axis y").status, 0);
  says(tool("info b.ply").out, "order       ascending along y");
}

TEST_F(Info, ReportsProgressToPrograms) {
  ASSERT_EQ(tool("generate plane a.ply -n 1000").status, 0);
  EXPECT_EQ(tool("info a.ply --progress-fd 5 5>progress").status, 0);
  EXPECT_NE(contents(folder_ / "progress").find(R"({"phase":"info","done":1000,"total":1000,)"), std::string::npos);
}

TEST_F(Info, RefusesWhatIsMissingOrNoCloud) {
  refused(2, "info", "FILE");
  refused(1, "info nothing.ply", "nothing.ply");
  write("noise.ply", "this is prose, not points");
  refused(1, "info noise.ply", "noise.ply");
}

}  // namespace
}  // namespace pointsweep
