// SPDX-License-Identifier: MIT
/// Runs on LAZ files have the results of runs on LAS files with equal points, for all options.
#include "pointsweep/formats/format.h"
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class CompressedFiles : public Tool {
 protected:
  void SetUp() override {
    if (!has_codecs()) GTEST_SKIP() << "built without codecs";
    for (const char* name : {"a.las", "a.laz"})
      ASSERT_EQ(tool(std::string("generate tls -n 120k --outliers 0.001 --quiet ") + name).status, 0);
    ASSERT_LT(std::filesystem::file_size(folder_ / "a.laz"), std::filesystem::file_size(folder_ / "a.las") * 3 / 4);
  }

  std::string out_of(const std::string& in, const std::string& out, const std::string& options) {
    const Result run = tool("run " + in + " " + out + " --force --quiet --no-provenance " + options);
    EXPECT_EQ(run.status, 0) << run.err;
    return contents(folder_ / out);
  }

  static constexpr const char* kChains[] = {
      "--pipeline 'knn(k=8) | normals'",
      "--pipeline 'knn(k=8) | normals' --order sweep --memory 64M",
      "--pipeline 'knn(k=6) | normals | splats | fair' --memory 64M --threads 1",
      "--pipeline 'knn(k=8) | sor | where(outlier == 0) | normals'",
  };
};

TEST_F(CompressedFiles, GiveTheSameResultsAsLas) {
  for (const char* options : kChains) {
    SCOPED_TRACE(options);
    EXPECT_TRUE(out_of("a.las", "from_las.las", options) == out_of("a.laz", "from_laz.las", options));
  }
}

TEST_F(CompressedFiles, HoldTheSameResultsAsLas) {
  for (const char* options : kChains) {
    SCOPED_TRACE(options);
    out_of("a.las", "r.las", options);
    out_of("a.laz", "r.laz", options);
    // The bytes of LAS and LAZ differ, so a run that keeps every row and value converts both to PLY.
    EXPECT_TRUE(out_of("r.las", "las.ply", "--pipeline 'where(x > -1e300)'") ==
                out_of("r.laz", "laz.ply", "--pipeline 'where(x > -1e300)'"));
  }
}

TEST_F(CompressedFiles, AreVerifiedAndMergedWithLas) {
  out_of("a.laz", "n.laz", "--pipeline 'knn(k=8) | normals'");
  const Result check = tool("verify a.laz n.laz --sample 500 --pipeline 'knn(k=8) | normals'");
  EXPECT_EQ(check.status, 0) << check.out << check.err;
  ASSERT_EQ(tool("generate statue -n 5k --quiet b.las").status, 0);
  const Result merged = tool("normals a.laz b.las -o m.laz --quiet");
  EXPECT_EQ(merged.status, 0) << merged.err;
  const Result both = tool("verify a.laz b.las m.laz --sample 500 --pipeline normals");
  EXPECT_EQ(both.status, 0) << both.out << both.err;
  EXPECT_NE(both.out.find("125,000"), std::string::npos) << both.out;
}

TEST_F(CompressedFiles, GoOnAfterAnInterruption) {
  const std::string options = "--pipeline 'knn(k=8) | normals' --memory 64M";
  const std::string expected = out_of("a.laz", "whole.laz", options);
  tool_under("timeout --foreground -s KILL 0.15", "run a.laz r.laz --quiet --no-provenance --resume work " + options);
  const Result again = tool("run a.laz r.laz --quiet --no-provenance --resume work --force " + options);
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_TRUE(contents(folder_ / "r.laz") == expected);
}

}  // namespace
}  // namespace pointsweep
