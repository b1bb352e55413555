// SPDX-License-Identifier: MIT
/// Points from standard input and to standard output.
#include <gmock/gmock.h>

#include "tests/cli/tool.h"
#include "tests/support/sanitizers.h"

namespace pointsweep {
namespace {

using testing::HasSubstr;

class StandardStreams : public Tool {
 protected:
  StandardStreams() {
    made("generate statue in.ply -n 20000 --noise 0.002");
    made("normals in.ply right.ply --no-provenance");
    std::filesystem::create_directory(folder_ / "temp");
  }

  /// Runs a script in the folder of the test, in which $T is the tool. A failure of any command of a pipe counts.
  Result script(const std::string& text) {
    write(".script", "set -o pipefail\nT=" + program() + "\n" + text + "\n");
    const int state = std::system(("cd '" + folder_.string() + "' && exec bash .script >.out 2>.err").c_str());
    return {WIFEXITED(state) ? WEXITSTATUS(state) : 128 + WTERMSIG(state), contents(folder_ / ".out"),
            contents(folder_ / ".err")};
  }
};

TEST_F(StandardStreams, APipeGivesTheBytesOfAFile) {
  for (const char* options : {"", "--order sweep", "--memory 40M --temp-dir temp", "--threads 1"}) {
    SCOPED_TRACE(options);
    const std::string given = options;
    made("normals in.ply right.ply --force --no-provenance " + given);
    const Result piped = script("cat in.ply | $T normals - - --no-provenance " + given + " | cat");
    EXPECT_EQ(piped.status, 0) << piped.err;
    EXPECT_TRUE(piped.out == contents(folder_ / "right.ply"));
    EXPECT_THAT(piped.err, HasSubstr("wrote standard output: 20000 points"));
    EXPECT_TRUE(std::filesystem::is_empty(folder_ / "temp"));
  }
}

TEST_F(StandardStreams, ARedirectedFileIsReadInPlace) {
  const Result file = script("$T normals - out.ply --no-provenance --temp-dir temp < in.ply");
  EXPECT_EQ(file.status, 0) << file.err;
  EXPECT_TRUE(contents(folder_ / "out.ply") == contents(folder_ / "right.ply"));
  EXPECT_EQ(script("$T normals in.ply - --no-provenance > out2.ply").status, 0);
  EXPECT_TRUE(contents(folder_ / "out2.ply") == contents(folder_ / "right.ply"));
}

TEST_F(StandardStreams, AnyFormatIsRecognisedByItsContent) {
  made("sort in.ply a.xyz --axis x");
  made("sort in.ply a.las --axis x");
  for (const char* name : {"a.xyz", "a.las"}) {
    const Result info = script(std::string("cat ") + name + " | $T info - --json");
    EXPECT_EQ(info.status, 0) << info.err;
    EXPECT_THAT(info.out, HasSubstr("\"points\": 20000"));
  }
  const Result kitti = script("head -c 1600 /dev/zero | $T info - --format kitti --json");
  EXPECT_THAT(kitti.out, HasSubstr("\"points\": 100")) << kitti.err;
}

TEST_F(StandardStreams, VerbsFormAChain) {
  const Result chain = script(
      "$T generate sphere - -n 5000 | $T normals - - | $T run - - --pipeline 'curvature' | "
      "$T verify - <(cat) 2>/dev/null; $T generate sphere - -n 5000 | $T normals - - | tee n.ply | $T render - p.png "
      "&& "
      "$T generate sphere s.ply -n 5000 && $T verify s.ply n.ply --sample 200");
  EXPECT_EQ(chain.status, 0) << chain.err;
  EXPECT_EQ(contents(folder_ / "p.png").substr(1, 3), "PNG");
}

TEST_F(StandardStreams, StandardInputIsOneOfSeveralInputs) {
  made("normals in.ply in.ply -o both.ply --no-provenance");
  const Result piped = script("cat in.ply | $T normals in.ply - -o out.ply --no-provenance");
  EXPECT_EQ(piped.status, 0) << piped.err;
  EXPECT_TRUE(contents(folder_ / "out.ply") == contents(folder_ / "both.ply"));
  EXPECT_EQ(script("cat in.ply | $T normals - - -o out2.ply").status, 2);
  EXPECT_THAT(contents(folder_ / ".err"), HasSubstr("only once"));
}

TEST_F(StandardStreams, ErrorsLeaveStandardOutputEmpty) {
  const Result empty = script("$T normals - - < /dev/null");
  EXPECT_EQ(empty.status, 1);
  EXPECT_EQ(empty.out, "");
  EXPECT_TRUE(empty.err.starts_with("error: -: is empty")) << empty.err;
  const Result truncated = script("head -c 100000 in.ply | $T normals - -");
  EXPECT_EQ(truncated.status, 1);
  EXPECT_EQ(truncated.out, "");
  EXPECT_THAT(truncated.err, HasSubstr("error: -: "));
  const Result resumed = script("cat in.ply | $T normals - out.ply --resume done");
  EXPECT_EQ(resumed.status, 2);
  EXPECT_THAT(resumed.err, HasSubstr("save it to a file first"));
  const Result no_folder = script("cat in.ply | $T normals - out.ply --temp-dir nowhere");
  EXPECT_EQ(no_folder.status, 1);
  EXPECT_THAT(no_folder.err, HasSubstr("choose another folder with --temp-dir"));
  const Result full = script("ulimit -f 100; cat in.ply | $T normals - out.ply --temp-dir temp");
  EXPECT_EQ(full.status, 1);
  EXPECT_THAT(full.err, HasSubstr("cannot hold a temporary copy of standard input"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "temp"));
}

/// Output "-" is PLY, unless --output-format names another format that is written sequentially.
TEST_F(StandardStreams, OutputFormatIsThatOfStandardOutput) {
  made("sort in.ply in.las --axis x");
  const char* const kRuns[] = {"convert {} {}", "run {} {} --pipeline 'knn(k=8) | normals | where(nz > 0)'",
                               "run {} {} --order sweep --memory 40M --temp-dir temp --pipeline normals",
                               "convert {} -o {} --keep x,y,z --threads 1"};
  std::size_t turn = 0;  // the inputs take turns
  for (const char* run : kRuns)
    for (const char* format : {"csv", "xyz", "pts", "PCD", "ply"}) {
      const char* const input = ++turn % 2 == 0 ? "in.ply" : "in.las";
      const std::string name = std::string("file.") + format;
      const std::string to_file = fmt::format(fmt::runtime(run), input, name) + " --no-provenance";
      SCOPED_TRACE(to_file);
      made(to_file + " -f");
      const std::string to_pipe = fmt::format(fmt::runtime(run), input, "-") + " --no-provenance";
      const Result piped = script("$T " + to_pipe + " --output-format " + format + " | cat");
      EXPECT_EQ(piped.status, 0) << piped.err;
      EXPECT_THAT(piped.err, HasSubstr("wrote standard output: "));
      EXPECT_TRUE(piped.out == contents(folder_ / name));
      EXPECT_FALSE(piped.out.empty());
    }
  EXPECT_FALSE(exists("-"));
  EXPECT_FALSE(exists("-.csv"));
  EXPECT_EQ(script("$T convert in.las - --output-format xyz > v.xyz && $T verify in.las v.xyz").status, 0)
      << contents(folder_ / ".err");
  EXPECT_EQ(script("$T run in.ply - --output-format csv --pipeline 'where(x > 1e9)'").out, "x,y,z,nx,ny,nz\n")
      << contents(folder_ / ".err");
}

TEST_F(StandardStreams, RefusesFormatsWhoseHeaderIsCompletedLast) {
  for (const char* format : {"las", "laz", "e57"}) {
    SCOPED_TRACE(format);
    const Result result = script(fmt::format("$T run in.ply - --output-format {} --pipeline normals", format));
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, HasSubstr("cannot be written to standard output, since its header is completed last"));
  }
  EXPECT_THAT(script("$T convert in.ply - --output-format off").err, HasSubstr("'off' is not one of"));
  EXPECT_THAT(script("$T convert in.ply - --output-format csv --scale 0.1").err, HasSubstr("--scale: is for LAS"));
  EXPECT_THAT(script("$T tile in.ply - --size 1 --output-format csv").err, HasSubstr("many files are written"));
}

/// A reader that closes the pipe ends a run without an error. A run that has not completed its other outputs reports
/// that.
TEST_F(StandardStreams, AReaderThatEndsEndsTheRunInSilence) {
  made("generate statue large.ply -n 200000");
  for (const char* options : {"", "--output-format csv", "--output-format csv --order sweep --threads 1"}) {
    SCOPED_TRACE(options);
    const Result enough = script(fmt::format("$T normals large.ply - --quiet {} | head -c 1000 | wc -c", options));
    EXPECT_EQ(enough.status, 0);
    EXPECT_EQ(enough.out, "1000\n");
    EXPECT_EQ(enough.err, "");
  }
  const Result closed = script("$T normals large.ply - --quiet --stats s.json | head -c 1000 | wc -c");
  EXPECT_EQ(closed.status, 1);
  EXPECT_FALSE(exists("s.json"));
  EXPECT_THAT(closed.err, HasSubstr("the program that reads standard output ended"));
  EXPECT_EQ(std::count(closed.err.begin(), closed.err.end(), '\n'), 1) << closed.err;
}

// Background jobs of a shell ignore SIGINT, so this test and the following ones send SIGTERM.
TEST_F(StandardStreams, AStopWhileAPipeIsReadLeavesNothing) {
  const Result stopped = script(
      "mkfifo p; $T normals - out.ply --temp-dir temp < p & exec 3> p; cat in.ply >&3; sleep 0.6\n"
      "kill -TERM $!; wait $!; echo status $?");
  EXPECT_EQ(stopped.out, "status 143\n");
  EXPECT_EQ(stopped.err, "error: stopped; no output was written\n");
  EXPECT_FALSE(exists("out.ply"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "temp"));
}

TEST_F(StandardStreams, AStopWhileTheReaderOfAPipeWaitsIsSeen) {
  made("generate statue large.ply -n 200000");
  const Result stopped = script(
      "mkfifo p; $T normals large.ply - --quiet > p & exec 3< p; read -r -n 3 <&3; sleep 0.3\n"
      "kill -TERM $!; wait $!; echo status $?");
  EXPECT_EQ(stopped.out, "status 143\n");
  EXPECT_EQ(stopped.err, "error: stopped; what standard output has got is incomplete\n");
}

TEST_F(StandardStreams, AnErrorBeforeTheFirstPointLeavesStandardOutputEmpty) {
  made("generate statue large.ply -n 1M");
  const Result result = script("ulimit -f 100; $T normals large.ply - --memory 60M --temp-dir temp | cat");
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err, HasSubstr("a temporary file in 'temp' may not grow"));
}

/// The copy of a pipe takes no memory.
TEST_F(StandardStreams, APipeLargerThanTheBudgetIsRead) {
  if (has_sanitizer()) GTEST_SKIP() << "sanitizers take memory of their own";
  made("generate statue large.ply -n 3M --double");  // 72 MB without normals
  const Result piped =
      script("cat large.ply | $T normals - out.ply --memory 60M --temp-dir temp --stats s.json --quiet");
  EXPECT_EQ(piped.status, 0) << piped.err;
  const std::string stats = contents(folder_ / "s.json");
  const std::size_t at = stats.find("\"peak_rss_bytes\": ");
  ASSERT_NE(at, stats.npos);
  EXPECT_LT(std::stoull(stats.substr(at + 18)), 60u << 20);
}

}  // namespace
}  // namespace pointsweep
