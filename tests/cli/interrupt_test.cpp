// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <random>
#include <set>
#include <thread>

#include "tests/cli/every_verb.h"
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

using Clock = std::chrono::steady_clock;

class Interrupt : public Tool {
 protected:
  pid_t start(const std::string& arguments) const {
    const pid_t child = fork();
    if (child != 0) return child;
    std::signal(SIGINT, SIG_DFL);  // background jobs of a shell ignore SIGINT, and the tool would inherit that
    const std::string command =
        "cd '" + folder_.string() + "' && exec " + program() + " " + arguments + " >/dev/null 2>/dev/null";
    execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
    _exit(98);
  }
  /// Waits until the tool has set its signal handlers, or has ended. Before, a signal has its default effect.
  static void wait_for_handlers(pid_t child) {
    const auto catches_termination = [&] {
      std::ifstream status("/proc/" + std::to_string(child) + "/status");
      for (std::string word; status >> word;) {
        if (word == "State:" && status >> word && word == "Z") return true;
        if (word == "SigCgt:" && status >> word) return (std::stoull(word, nullptr, 16) >> (SIGTERM - 1) & 1) != 0;
      }
      return true;
    };
    while (!catches_termination()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  static int status_of(pid_t child) {
    int state = 0;
    waitpid(child, &state, 0);
    return WIFEXITED(state) ? WEXITSTATUS(state) : -WTERMSIG(state);
  }
  /// Starts a run that would take hours, sends `signal` as soon as its output exists, and returns the exit status.
  int status_after(int signal) {
    const pid_t child = start("generate statue out.xyz -n 10G");
    while (std::filesystem::is_empty(folder_)) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    kill(child, signal);
    return status_of(child);
  }
  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
      names.insert(entry.path().filename().string());
    return names;
  }

  /// Sends SIGTERM `delay` seconds after the tool has started. Returns the seconds until the run has ended; absent if
  /// it ended before the signal.
  std::optional<double> seconds_to_end(const std::string& arguments, double delay) const {
    const pid_t child = start(arguments);
    wait_for_handlers(child);
    std::this_thread::sleep_for(std::chrono::duration<double>(delay));
    const Clock::time_point sent = Clock::now();
    kill(child, SIGTERM);
    const int status = status_of(child);
    const double seconds = std::chrono::duration<double>(Clock::now() - sent).count();
    if (status == 0) return std::nullopt;
    EXPECT_EQ(status, 143) << arguments;
    return seconds;
  }
  void expect_quick_ends(int turns, double longest);
  bool ends_quickly(const std::string& run, double after);
};

TEST_F(Interrupt, CtrlCEndsWithStatus130AndLeavesNothing) {
  EXPECT_EQ(status_after(SIGINT), 130);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(Interrupt, TerminationEndsWithStatus143AndLeavesNothing) {
  EXPECT_EQ(status_after(SIGTERM), 143);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

/// Calls the handler of the timer that ends a run which does not stop by itself, before the run sees the first signal.
TEST_F(Interrupt, WhatEndsAtOnceLeavesNothingEither) {
  ASSERT_EQ(tool("generate statue s.ply -n 300K").status, 0);
  std::filesystem::create_directory(folder_ / "tmp");
  const std::set<std::string> before = files();
  std::string ten;
  for (int i = 0; i < 10; ++i) ten += "s.ply ";
  const pid_t child = start("normals " + ten + "-o out.ply -k 300 --memory 64M --temp-dir tmp");
  wait_for_handlers(child);
  const auto grows = [&](const std::filesystem::path& folder, const std::string& begin) {
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (entry.path().filename().string().starts_with(begin)) return true;
    return false;
  };
  const Clock::time_point begun = Clock::now();
  while (!grows(folder_, ".out.ply.") || !grows(folder_ / "tmp", "pointsweep-")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ASSERT_LT(Clock::now() - begun, std::chrono::seconds(60)) << "the run never began";
  }
  for (const int signal : {SIGSTOP, SIGTERM, SIGALRM, SIGCONT}) kill(child, signal);
  EXPECT_EQ(status_of(child), 143);
  EXPECT_EQ(files(), before);
}

/// Returns runs that take from seconds to hours. `many` names one file forty times: a cloud of 12 million points.
std::vector<std::string> long_runs() {
  std::string many;
  for (int i = 0; i < 40; ++i) many += "s.ply ";
  const std::string place = " --temp-dir tmp";
  return {
      "generate statue out.las -n 10G",
      "info " + many + many + many,
      "sort " + many + "out.ply" + place,
      "sort " + many + "out.ply --memory 64M" + place,
      "normals s.ply out.ply --radius 0.5" + place,
      "normals s.ply out.xyz --radius 10 --memory 128M" + place,
      "normals " + many + "out.ply -k 300 --memory 128M" + place,
      "normals " + many + "out.ply --engine reference" + place,
      "curvature s.ply out.ply --radius 0.4 --memory 100M" + place,
      "splats s.ply out.ply -k 8000" + place,
      "fair s.ply out.ply --radius 0.3 --order sweep" + place,
      "neighbors s.ply out.npy -k 5000" + place,
      "run s.ply out.ply --pipeline 'knn(radius=0.2) | normals | curvature | splats | fair | reneighbor | normals'" +
          place,
      "normals s.ply out.ply --radius 0.5 --resume kept",
      "normals tiles out/ --recursive -k 300" + place,
      "convert " + many + "out.laz" + place,
      "features " + many + "out.ply -k 300" + place,
      "denoise " + many + "out.ply -k 300" + place,
      "thin " + many + "out.ply --poisson 0.01" + place,
      "transform " + many + "out.laz --translate 1,2,3" + place,
      "tile " + many + "out/ --size 0.1" + place,
      "split " + many + "out/ --parts 7" + place,
      "ground " + many + "out.ply --cell 0.01 --window 0.1 --height" + place,
      "render " + many + "out.png",
      "render s.ply out.png --size 8000x8000",
      "verify s.ply normals.ply --radius 0.3 --pipeline normals",
      "verify s.ply normals.ply --pipeline 'knn(k=300) | normals'",
  };
}

/// Stops every run `turns` times, each time after another delay from 0.05 to `longest` seconds.
void Interrupt::expect_quick_ends(int turns, double longest) {
  ASSERT_EQ(tool("generate statue s.ply -n 300K").status, 0);
  ASSERT_EQ(tool("normals s.ply normals.ply").status, 0);
  std::filesystem::create_directory(folder_ / "tmp");
  std::filesystem::create_directories(folder_ / "tiles/deep");
  for (const char* name : {"tiles/a.ply", "tiles/deep/b.ply"})
    std::filesystem::copy_file(folder_ / "s.ply", folder_ / name);
  std::mt19937 random(20);
  std::uniform_real_distribution<double> delay(0.05, longest);
  for (const std::string& run : long_runs()) {
    int interrupted = 0;
    for (int turn = 0; turn < turns; ++turn) interrupted += ends_quickly(run, delay(random) / (1 + 3 * turn));
    EXPECT_GT(interrupted, 0) << run << ": was over before the signal";
  }
}

/// Returns whether the run was still at work when the signal came.
bool Interrupt::ends_quickly(const std::string& run, double after) {
  const std::set<std::string> before = files();
  // A busy machine may keep a process waiting for longer than it works, so the best of three attempts counts.
  std::optional<double> least;
  for (int attempt = 0; attempt < 3 && (!least || *least >= 1); ++attempt) {
    const std::optional<double> seconds = seconds_to_end(run, after);
    if (!seconds) break;
    least = std::min(seconds, least ? least : seconds);
  }
  std::filesystem::remove_all(folder_ / "kept");
  if (!least) {
    for (const char* made : {"out.ply", "out.png", "out.npy"}) std::filesystem::remove(folder_ / made);
    return false;
  }
  EXPECT_LT(*least, 1) << run << "\nafter " << after << " s";
  EXPECT_EQ(files(), before) << run << "\nafter " << after << " s";
  return true;
}

TEST_F(Interrupt, RunsOfEveryVerbThatWorksForLongAreStopped) {
  const std::set<std::string> quick{"operators", "completion", "man", "help"};
  for (const std::string& verb : every_verb())
    EXPECT_NE(std::ranges::any_of(long_runs(), [&](const std::string& run) { return run.starts_with(verb + ' '); }),
              quick.contains(verb))
        << verb;
}

TEST_F(Interrupt, EveryVerbEndsWithinASecondAndLeavesNothing) { expect_quick_ends(1, 0.3); }

/// Stops every verb, with delays that reach every phase.
TEST_F(Interrupt, EveryVerbEndsWithinASecondInEveryPhaseAndLeavesNothing) { expect_quick_ends(2, 1.6); }

}  // namespace
}  // namespace pointsweep
