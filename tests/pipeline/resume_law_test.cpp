// SPDX-License-Identifier: MIT
/// The law of --resume: a run of any operator that is killed in every phase and resumed with the same memory gives the
/// bytes of an uninterrupted run.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>

#include "pointsweep/error.h"
#include "pointsweep/pipeline/engine_run.h"
#include "pointsweep/pipeline/language/build_chain.h"
#include "tests/formats/temporary_folder.h"
#include "tests/support/examples.h"
#include "tests/support/watching.h"

namespace pointsweep {
namespace {

class ResumeLaw : public testing::Test {
 protected:
  ResumeLaw() {
    write_points(folder_ / "in.ply", cloud_for_examples(20000, 1));
    write_labelled_points(folder_ / "other.ply", cloud_for_examples(5000, 2));
  }

  EngineOptions options(const std::string& output, std::uint64_t memory) const {
    EngineOptions options;
    options.slab_points = 5000;
    options.resources.threads = 2;
    options.resources.memory_bytes = memory;
    options.resources.temp_folder = folder_.path();
    options.resume_folder = folder_ / (output + ".done");
    options.checkpoint_seconds = 0;
    return options;
  }

  Statistics run_example(const Example& example, const std::string& output, const EngineOptions& options) const {
    InputCloud cloud({folder_ / "in.ply"});
    return run(cloud, build_chain(parse_pipeline(example.pipeline), cloud), {folder_ / output, {}, {}}, options);
  }

  /// Returns the least budget with which the example runs; 64 MB for an example that is never refused.
  std::uint64_t least_memory(const Example& example) const {
    const std::string give = "give --memory ";
    std::string refusal = give + "64M";
    try {
      run_example(example, "whole.ply", options("whole.ply", 1 << 20));
      std::filesystem::remove(folder_ / "whole.ply");
    } catch (const Error& error) {
      refusal = error.what();
    }
    const std::size_t at = refusal.find(give);
    if (at == std::string::npos) throw std::runtime_error(refusal);
    return std::stoull(refusal.substr(at + give.size())) << 20;
  }

  /// Returns the number of processes of a run. Each phase ends a process at its first report, and a sweep ends another
  /// one between its slabs.
  std::size_t run_killed_in_every_phase(const Example& example, const std::string& output, EngineOptions options) {
    std::map<std::string, int> kills;
    for (std::size_t processes = 1;; ++processes) {
      std::map<std::string, int> reports;
      Watching watching([&](const Progress& progress) {
        const int times = kills[progress.phase], most = std::string(progress.phase) == "sweeping" ? 2 : 1;
        if (times == most || ++reports[progress.phase] < 1 + 2 * times) return;
        ++kills[progress.phase];
        throw Cancelled();
      });
      options.observer = &watching;
      try {
        run_example(example, output, options);
        return processes;
      } catch (const Cancelled&) {
      }
    }
  }

  void expect_same_when_killed(const Example& example) {
    SCOPED_TRACE(example.pipeline);
    const std::uint64_t memory = least_memory(example);
    run_example(example, "whole.ply", options("whole.ply", memory));
    std::size_t processes = 0;
    ASSERT_NO_THROW(processes = run_killed_in_every_phase(example, "killed.ply", options("killed.ply", memory)));
    EXPECT_GT(processes, 1u);
    EXPECT_TRUE(contents(folder_ / "killed.ply") == contents(folder_ / "whole.ply"));
  }

  TemporaryFolder folder_;
};

class ResumeLawOf : public ResumeLaw, public testing::WithParamInterface<std::string> {};

TEST_P(ResumeLawOf, KilledInEveryPhaseItGivesTheSameBytesInTheSameMemory) {
  expect_same_when_killed(example_of(GetParam(), (folder_ / "other.ply").string()));
}

TEST_F(ResumeLaw, HoldsForTheRowsOfTheInput) {
  expect_same_when_killed({"row", "knn(k=5) | where(row >= 500) | normals | where(nz > 0) | set(id = row, as=uint64)"});
}

INSTANTIATE_TEST_SUITE_P(EveryOperator, ResumeLawOf, testing::ValuesIn(names_of_all_operators()),
                         [](const auto& tested) { return tested.param; });

TEST_F(ResumeLaw, ARunThatNamesNoMemoryGoesOnWithThatOfTheFirst) {
  const Example example{"normals", "normals"};
  EngineOptions first = options("out.ply", 77 << 20);
  Watching stopping([](const Progress& progress) {
    if (std::string(progress.phase) == "writing") throw Cancelled();
  });
  first.observer = &stopping;
  EXPECT_THROW(run_example(example, "out.ply", first), Cancelled);
  EXPECT_EQ(run_example(example, "out.ply", options("out.ply", 0)).memory_budget_bytes, std::uint64_t{77} << 20);
}

}  // namespace
}  // namespace pointsweep
