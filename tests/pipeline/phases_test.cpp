// SPDX-License-Identifier: MIT
/// A run gives equal bytes if each phase runs in a process of its own, which has only the command and the encoded
/// values of the previous process.
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "pointsweep/error.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/formats/temporary_folder.h"
#include "tests/support/examples.h"
#include "tests/support/watching.h"

extern char** environ;

namespace pointsweep {
namespace {

constexpr const char* kFolder = "POINTSWEEP_PHASE_FOLDER";
constexpr const char* kPipeline = "POINTSWEEP_PHASE_PIPELINE";
constexpr int kMorePhases = 3;

void run_in(const std::filesystem::path& folder, const std::string& pipeline, const std::string& output,
            Observer* observer) {
  EngineOptions options;
  options.slab_points = 1000;
  options.resources.threads = 2;
  options.resources.memory_bytes = 64 << 20;
  options.resources.temp_folder = folder;
  options.observer = observer;
  if (observer != nullptr) options.resume_folder = folder / "done";
  InputCloud cloud({folder / "in.ply"});
  run(cloud, build_chain(parse_pipeline(pipeline), cloud), {folder / output, {}, {}}, options);
}

/// Ends the run at the first report of a second phase. Reports of "connecting" belong to the sweep.
int run_one_phase(const std::filesystem::path& folder, const std::string& pipeline) {
  std::string first;
  Watching watching([&](const Progress& progress) {
    const std::string phase = progress.phase;
    if (first.empty()) first = phase;
    if (phase != first && phase != "connecting") throw Cancelled();
  });
  try {
    run_in(folder, pipeline, "phases.ply", &watching);
  } catch (const Cancelled&) {
    return kMorePhases;
  }
  return 0;
}

/// Runs the test PhaseOfARun in another process and returns its exit status.
int run_process() {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  std::vector<std::string> words = {self, "--gtest_filter=PhaseOfARun.DISABLED_InThisProcess",
                                    "--gtest_also_run_disabled_tests", "--gtest_output="};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = 0;
  if (::posix_spawn(&child, self.c_str(), nullptr, nullptr, arguments.data(), environ) != 0) return -1;
  int status = 0;
  return ::waitpid(child, &status, 0) == child && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(PhaseOfARun, DISABLED_InThisProcess) { std::exit(run_one_phase(std::getenv(kFolder), std::getenv(kPipeline))); }

class PhasesOf : public testing::TestWithParam<const char*> {};

TEST_P(PhasesOf, AreProcessesThatGiveTheSameBytes) {
  const TemporaryFolder folder;
  write_points(folder / "in.ply", cloud_for_examples(4000, 1));
  const std::string pipeline = GetParam();
  run_in(folder.path(), pipeline, "whole.ply", nullptr);
  ::setenv(kFolder, folder.path().c_str(), 1);
  ::setenv(kPipeline, pipeline.c_str(), 1);
  int processes = 0, status = kMorePhases;
  for (; status == kMorePhases && processes < 30; ++processes) status = run_process();
  EXPECT_EQ(status, 0);
  EXPECT_GE(processes, 3);  // order, sweep, write
  EXPECT_TRUE(contents(folder / "phases.ply") == contents(folder / "whole.ply"));
  EXPECT_FALSE(std::filesystem::exists(folder / "done"));
}

INSTANTIATE_TEST_SUITE_P(OfChains, PhasesOf,
                         testing::Values("knn(k=8) | normals | curvature", "knn(k=8) | sor | where(outlier == 0)",
                                         "knn(k=12) | voxel(0.5) | normals", "knn(k=12) | poisson(0.5) | normals",
                                         "knn(k=8) | sor | where(outlier == 0) | ground(cell=1, window=18)",
                                         "knn(k=8) | components | where(component_size > 100)",
                                         "knn(k=64) | normals | splats | fair | reneighbor(k=12) | normals",
                                         "knn(k=64) | normals | splats | fair | resort | normals"));

}  // namespace
}  // namespace pointsweep
