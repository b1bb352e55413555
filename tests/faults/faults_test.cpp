// SPDX-License-Identifier: MIT
/// Runs whose file operations go wrong, one after the other; script/faults tries many more.
#include <algorithm>
#include <chrono>
#include <set>
#include <sstream>
#include <thread>
#include <vector>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class Faults : public Tool {
 protected:
  Faults() {
    EXPECT_EQ(tool("generate statue in.ply -n 3000 --noise 0.002").status, 0);
    std::filesystem::create_directory(folder_ / "temp");
  }

  static constexpr const char* kRun =
      "normals in.ply out.ply --order sweep --memory 30M --temp-dir temp --threads 1 --quiet";

  /// Runs the tool with these settings of the shim.
  Result faulty(const std::string& settings, const std::string& run = kRun) {
    return tool_under("FAULTS_FOLDERS='" + folder_.string() + "' " + settings + " LD_PRELOAD='" POINTSWEEP_FAULTS "'",
                      run);
  }
  /// Returns the names of the operations of a run without faults, in order. Stores its output in right_.
  std::vector<std::string> operations() {
    EXPECT_EQ(faulty("FAULTS_LOG=.log").status, 0);
    std::istringstream lines(contents(folder_ / ".log"));
    std::vector<std::string> names;
    for (std::string number, name, path; lines >> number >> name && std::getline(lines, path);) names.push_back(name);
    right_ = contents(folder_ / "out.ply");
    std::filesystem::remove(folder_ / "out.ply");
    std::filesystem::remove(folder_ / ".log");
    return names;
  }
  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
      names.insert(entry.path().lexically_relative(folder_).string());
    return names;
  }
  /// Expects an error of one sentence and no files left, or success and the right output.
  void expect_all_or_nothing(const Result& result) {
    EXPECT_TRUE(result.status == 0 || result.status == 1) << result.status << result.err;
    if (result.status == 1) {
      EXPECT_TRUE(result.err.starts_with("error: ")) << result.err;
      EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    } else {
      EXPECT_TRUE(contents(folder_ / "out.ply") == right_);
      std::filesystem::remove(folder_ / "out.ply");
    }
    EXPECT_EQ(files(), (std::set<std::string>{".err", ".out", "in.ply", "temp"}));
  }

  std::string right_;
};

TEST_F(Faults, AFullDiskAtAnyOperationLeavesNothing) {
  const std::vector<std::string> names = operations();
  int refused = 0;
  for (std::size_t at = 1; at <= names.size(); ++at) {
    SCOPED_TRACE(std::to_string(at) + " " + names[at - 1]);
    const Result result = faulty("FAULTS_KIND=enospc FAULTS_AT=" + std::to_string(at));
    expect_all_or_nothing(result);
    refused += result.status;
  }
  EXPECT_GT(refused, 5);
}

TEST_F(Faults, NoOutputAppearsWhileAnotherCannotBeWritten) {
  constexpr const char* kTwoFiles = "neighbors in.ply out.npy --distances far.npy --threads 2 --quiet";
  EXPECT_EQ(faulty("FAULTS_LOG=.log", kTwoFiles).status, 0);
  std::istringstream lines(contents(folder_ / ".log"));
  std::filesystem::remove(folder_ / ".log");
  int failed = 0;
  for (std::string at, name, path; lines >> at >> name && std::getline(lines, path);) {
    std::filesystem::remove(folder_ / "out.npy");
    std::filesystem::remove(folder_ / "far.npy");
    if (name != "write") continue;
    SCOPED_TRACE(at);
    EXPECT_EQ(faulty("FAULTS_KIND=eio FAULTS_AT=" + at, kTwoFiles).status, 1);
    EXPECT_EQ(files(), (std::set<std::string>{".err", ".out", "in.ply", "temp"}));
    ++failed;
  }
  EXPECT_GE(failed, 2);
}

TEST_F(Faults, AnErrorOfTheDiskAtAnyOperationLeavesNothing) {
  const std::vector<std::string> names = operations();
  int refused = 0;
  for (std::size_t at = 1; at <= names.size(); ++at) {
    SCOPED_TRACE(std::to_string(at) + " " + names[at - 1]);
    const Result result = faulty("FAULTS_KIND=eio FAULTS_AT=" + std::to_string(at));
    expect_all_or_nothing(result);
    refused += result.status;
  }
  EXPECT_GT(refused, 10);
}

TEST_F(Faults, ShortAndInterruptedTransfersAreContinued) {
  const std::vector<std::string> names = operations();
  for (const char* kind : {"short", "eintr"}) {
    for (const std::size_t at : {std::size_t{1}, names.size() / 2}) {
      const Result result = faulty(std::string("FAULTS_KIND=") + kind + " FAULTS_AT=" + std::to_string(at));
      EXPECT_EQ(result.status, 0) << result.err;
      expect_all_or_nothing(result);
    }
  }
}

TEST_F(Faults, KillNeverLeavesAPartialOutputAndTheNextRunCleansUp) {
  const std::vector<std::string> names = operations();
  const std::size_t step = std::max<std::size_t>(1, names.size() / 12);
  for (std::size_t at = 1; at <= names.size(); at += step) {
    SCOPED_TRACE(std::to_string(at) + " " + names[at - 1]);
    const Result killed = faulty("FAULTS_KIND=kill FAULTS_AT=" + std::to_string(at));
    EXPECT_EQ(killed.status, 128 + 9);
    EXPECT_TRUE(!exists("out.ply") || contents(folder_ / "out.ply") == right_);
    std::filesystem::remove(folder_ / "out.ply");
    const Result next = tool(kRun);
    EXPECT_EQ(next.status, 0) << next.err;
    expect_all_or_nothing(next);
  }
}

/// A run of two steps over four slabs, with a checkpoint after each.
class FaultsAndCheckpoints : public Faults {
 protected:
  FaultsAndCheckpoints() {
    right_ = made("generate statue in.ply -n 60000 --noise 0.002 --force", "in.ply");
    right_ = made("curvature in.ply out.ply --quiet", "out.ply");
    remove_output();
    EXPECT_EQ(faulty("FAULTS_LOG=.log", kRun).status, 0);
    EXPECT_EQ(contents(folder_ / "out.ply"), right_);
    remove_output();
    const std::string log = contents(folder_ / ".log");
    operations_ = static_cast<std::size_t>(std::count(log.begin(), log.end(), '\n'));
    std::filesystem::remove(folder_ / ".log");
  }
  static constexpr const char* kRun =
      "curvature in.ply out.ply --resume done --checkpoint-seconds 0 --memory 64M --threads 1 --quiet";

  void remove_output() { std::filesystem::remove(folder_ / "out.ply"); }
  /// Expects that an output is right if there is one, and that the next run, which resumes, completes it and leaves
  /// nothing else.
  void expect_to_go_on() {
    EXPECT_TRUE(!exists("out.ply") || contents(folder_ / "out.ply") == right_);
    remove_output();
    const Result next = tool(kRun);
    EXPECT_EQ(next.status, 0) << next.err;
    expect_all_or_nothing(next);
  }

  std::size_t operations_ = 0;
};

TEST_F(FaultsAndCheckpoints, KilledAtAnyOperationARunGoesOnToTheSameOutput) {
  std::size_t with_checkpoint = 0;
  for (std::size_t at = 1; at <= operations_; at += std::max<std::size_t>(1, operations_ / 24)) {
    SCOPED_TRACE(at);
    const int status = faulty("FAULTS_KIND=kill FAULTS_AT=" + std::to_string(at), kRun).status;
    // Checkpoints are written in the background, so the numbers of operations of two runs differ a little. The last
    // operations may not come.
    if (status != 0 || at + operations_ / 8 < operations_) {
      EXPECT_EQ(status, 128 + 9);
    }
    with_checkpoint += exists("done/checkpoint");
    expect_to_go_on();
  }
  EXPECT_GT(with_checkpoint, 8u);
}

TEST_F(FaultsAndCheckpoints, AFullDiskLeavesTheCheckpointBefore) {
  for (std::size_t at = 1; at <= operations_; at += std::max<std::size_t>(1, operations_ / 12)) {
    SCOPED_TRACE(at);
    const Result full = faulty("FAULTS_KIND=enospc FAULTS_AT=" + std::to_string(at), kRun);
    EXPECT_TRUE(full.status == 0 || full.status == 1) << full.status;
    EXPECT_EQ(exists("out.ply"), full.status == 0);
    expect_to_go_on();
  }
}

TEST_F(Faults, AnInputThatChangesGivesNoMixture) {
  const std::vector<std::string> names = operations();
  const std::string input = contents(folder_ / "in.ply");
  for (const char* kind : {"shrink", "grow", "rewrite"}) {
    for (std::size_t at = 5; at <= names.size(); ++at) {  // a change before the input is opened would be another input
      SCOPED_TRACE(std::string(kind) + " " + std::to_string(at));
      expect_all_or_nothing(
          faulty(std::string("FAULTS_TARGET=in.ply FAULTS_KIND=") + kind + " FAULTS_AT=" + std::to_string(at)));
      write("in.ply", input);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));  // longer than some ticks of the file system's clock
    }
  }
}

TEST_F(Faults, ATemporaryFolderThatGoesAwayIsSurvivedOrSaid) {
  const std::vector<std::string> names = operations();
  for (std::size_t at = 1; at <= names.size(); at += std::max<std::size_t>(1, names.size() / 8)) {
    SCOPED_TRACE(at);
    const Result result = faulty("FAULTS_TARGET=temp FAULTS_KIND=remove FAULTS_AT=" + std::to_string(at));
    std::filesystem::create_directory(folder_ / "temp");
    expect_all_or_nothing(result);
  }
}

TEST_F(Faults, ALimitOnFileSizesIsASentenceAndNoSignal) {
  for (const char* arguments : {"normals in.ply out.ply", "sort in.ply out.ply"}) {
    const Result result = tool_under("ulimit -f 20 && exec", arguments);  // blocks of 512 or 1024 bytes
    EXPECT_EQ(result.status, 1) << result.err;
    EXPECT_NE(result.err.find("ulimit -f"), std::string::npos) << result.err;
    EXPECT_FALSE(exists("out.ply"));
  }
}

TEST_F(Faults, AFolderThatMayNotBeWrittenIsASentence) {
  std::filesystem::create_directory(folder_ / "closed");
  std::filesystem::permissions(folder_ / "closed",
                               std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  if (std::ofstream(folder_ / "closed/probe")) GTEST_SKIP() << "this user may write anywhere";
  refused(1, "normals in.ply closed/out.ply", "no permission to write");
}

}  // namespace
}  // namespace pointsweep
