// SPDX-License-Identifier: MIT
/// The verb and the operator transform as a user runs them: files, tiles, a changed matrix file, and what verify says.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class TransformVerb : public Tool {
 protected:
  TransformVerb() {
    std::string text = "x y z nx ny nz intensity\n";
    for (int i = 0; i < 900; ++i)
      text += fmt::format("{} {} {} {} 0 {} {}\n", i % 30 * 0.5, i / 30 * 0.25, i * 37 % 101 * 0.01,
                          i % 2 == 0 ? 0.6 : 0, i % 2 == 0 ? 0.8 : 1, i);
    write("all.txt", text);
    write("m.txt", "0.8 -0.6 0 500000\n0.6 0.8 0 5000000\n0 0 1 -12.5\n0 0 0 1\n");
  }
};

TEST_F(TransformVerb, IsTheStageWithTheNumbersOfTheFile) {
  const std::string common = " -f -q --no-provenance ";
  const std::string numbers = "[0.8,-0.6,0,500000,0.6,0.8,0,5000000,0,0,1,-12.5]";
  const auto by_run = [&](const std::string& options) {
    return made(fmt::format("run all.txt run.ply {} --pipeline 'transform({})'", common, options), "run.ply");
  };
  EXPECT_EQ(made("transform all.txt verb.ply --matrix m.txt" + common, "verb.ply"), by_run(numbers));
  EXPECT_EQ(made("transform all.txt verb.ply --matrix m.txt --inverse" + common, "verb.ply"),
            by_run(numbers + ", inverse=yes"));
  EXPECT_EQ(made("transform all.txt verb.ply --translate 1,2,3" + common, "verb.ply"), by_run("translate=[1,2,3]"));
  for (const char* options : {"", " --inverse", " --scale 0.3048"})
    refused(2, std::string("transform all.txt out.las") + options,
            "transform: nothing says where the points go; give --matrix FILE or --translate X,Y,Z. To scale them write "
            "pointsweep run IN OUT --pipeline 'transform(scale=0.3048)'; --scale is the grid of LAS outputs.");
  write("m.txt", "1 0 0 0\n0 1 0 x\n");
  refused(1, "transform all.txt out.ply --matrix m.txt", "m.txt:2: 'x' is no finite number; a matrix is 4 rows of 4");
}

TEST_F(TransformVerb, VerifyEvaluatesMovesByItsOwnCodeForEveryFormat) {
  for (const char* out : {"out.las", "out.laz", "out.ply", "out.txt"}) {
    made(fmt::format("transform all.txt {} -q --matrix m.txt", out));
    const Result sound = tool(fmt::format("verify {}", out));
    EXPECT_EQ(sound.status, 0) << out << sound.out << sound.err;
    EXPECT_EQ(sound.out.find("by its own operator"), std::string::npos) << sound.out;
    EXPECT_NE(tool(fmt::format("info {}", out)).out.find("transform([0.8,-0.6,0,500000,"), std::string::npos);
    made(fmt::format("transform {} back.ply -f -q --matrix m.txt --inverse", out));
    EXPECT_EQ(tool("verify back.ply").status, 0) << out;
  }
  EXPECT_EQ(tool("verify all.txt out.ply --pipeline 'transform(m.txt, translate=[0,0,0.01])'").status, 1);
  made("run all.txt scored.ply -q --pipeline 'knn(k=6) | sor | transform(scale=2)'");
  EXPECT_EQ(tool("verify scored.ply").status, 0) << "outliers were found before their distances were scaled";
}

TEST_F(TransformVerb, TilesAndTheMergedCloudMoveAlike) {
  std::filesystem::create_directory(folder_ / "tiles");
  const std::string text = contents(folder_ / "all.txt");
  const std::size_t middle = text.find('\n', text.size() / 2) + 1;
  write("tiles/a.txt", text.substr(0, middle));
  write("tiles/b.txt", text.substr(0, text.find('\n') + 1) + text.substr(middle));
  const std::string options = " -q --no-provenance --matrix m.txt";
  made("transform tiles -o out/" + options);
  const std::string whole = made("transform all.txt -o whole.txt" + options, "whole.txt");
  const std::string second = contents(folder_ / "out/b.txt");
  EXPECT_EQ(contents(folder_ / "out/a.txt") + second.substr(second.find('\n') + 1), whole);
}

TEST_F(TransformVerb, AnotherMatrixOfTheSameFileIsAnotherRun) {
  made("generate terrain in.las -n 30000 --quiet");
  const std::string run =
      "run in.las out.txt --pipeline 'knn(k=6) | normals | transform(m.txt)' --resume done --quiet ";
  // The run stops because the output has no room. The folder of checkpoints stays.
  const Result stopped = tool_under("ulimit -f 2500 && exec", run + "--checkpoint-seconds 0");
  ASSERT_NE(stopped.status, 0);
  ASSERT_TRUE(exists("done")) << stopped.err;
  write("m.txt", "0.8 -0.6 0 500000\n0.6 0.8 0 5000000\n0 0 1 -13\n0 0 0 1\n");
  refused(1, run, "transform([");
}

}  // namespace
}  // namespace pointsweep
