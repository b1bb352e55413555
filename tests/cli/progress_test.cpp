// SPDX-License-Identifier: MIT
#include "cli/progress.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

namespace pointsweep {
namespace {

/// A display whose clock stands until it is moved, and what it wrote so far.
class ProgressDisplays : public testing::Test {
 protected:
  ProgressDisplays() {
    EXPECT_EQ(pipe(pipe_), 0);
    fcntl(pipe_[0], F_SETFL, O_NONBLOCK);
  }
  ~ProgressDisplays() override {
    close(pipe_[0]);
    close(pipe_[1]);
  }
  std::string written() {
    char buffer[4096];
    const ssize_t n = read(pipe_[0], buffer, sizeof buffer);
    return n > 0 ? std::string(buffer, static_cast<std::size_t>(n)) : "";
  }
  void wait(double seconds) { now_ += std::chrono::milliseconds(static_cast<int>(1000 * seconds)); }
  ProgressDisplay::Clock clock() {
    return [this] { return now_; };
  }

  int pipe_[2];
  std::chrono::steady_clock::time_point now_{std::chrono::hours(1)};
};

TEST_F(ProgressDisplays, LinesComeEveryFiveSecondsWithRateAndRemainingTime) {
  ProgressDisplay display({.people = pipe_[1]}, clock());
  display.report("sweeping", 0, 4'000'000);
  wait(4);
  display.report("sweeping", 900'000, 4'000'000);
  EXPECT_EQ(written(), "");
  wait(1);
  display.report("sweeping", 1'000'000, 4'000'000);
  EXPECT_EQ(written(), "pointsweep: sweeping 25 %, 1.00M of 4.00M points, 200K/s, 0:15 left\n");
  wait(1);
  display.report("sweeping", 1'100'000, 4'000'000);
  EXPECT_EQ(written(), "");
}

TEST_F(ProgressDisplays, ANewPhaseHasItsOwnClock) {
  ProgressDisplay display({.people = pipe_[1]}, clock());
  display.report("ordering", 0, 100);
  wait(100);
  display.report("sweeping", 0, 100);
  wait(5);
  display.report("sweeping", 50, 100);
  EXPECT_EQ(written(), "pointsweep: sweeping 50 %, 50 of 100 points, 10/s, 0:05 left\n");
}

TEST_F(ProgressDisplays, ATerminalGetsABarTenTimesASecondWhichIsTakenAwayAtTheEnd) {
  {
    ProgressDisplay display({.people = pipe_[1], .terminal = true}, clock());
    display.report("writing", 1, 2);
    EXPECT_EQ(written(), "\r\x1b[Kwriting    [############------------]  50 %  1 of 2 points");
    display.report("writing", 1, 2);
    EXPECT_EQ(written(), "");
    wait(0.1);
    display.report("writing", 1, 2);
    EXPECT_NE(written(), "");
  }
  EXPECT_EQ(written(), "\r\x1b[K");
}

TEST_F(ProgressDisplays, ABarNeverWraps) {
  ProgressDisplay display({.people = pipe_[1], .terminal = true, .columns = 20}, clock());
  display.report("writing", 1, 2);
  EXPECT_EQ(written(), "\r\x1b[Kwriting    [#######");
}

TEST_F(ProgressDisplays, ASentenceTakesThePlaceOfTheBar) {
  ProgressDisplay display({.people = pipe_[1], .terminal = true}, clock());
  display.report("writing", 1, 2);
  written();
  display.say("something is odd");
  EXPECT_EQ(written(), "\r\x1b[Kpointsweep: something is odd\n");
}

TEST_F(ProgressDisplays, ProgramsGetTheFirstAndTheLastOfAPhaseAndSomeBetween) {
  ProgressDisplay display({.programs = pipe_[1]}, clock());
  display.report("sweeping", 0, 100);
  wait(0.1);
  display.report("sweeping", 10, 100);
  wait(0.15);
  display.report("sweeping", 20, 100);
  display.report("sweeping", 100, 100);
  display.report("sweeping", 99, 100);  // another thread, late
  EXPECT_EQ(written(), R"({"phase":"sweeping","done":0,"total":100,"seconds":0.0})"
                       "\n"
                       R"({"phase":"sweeping","done":20,"total":100,"seconds":0.25})"
                       "\n"
                       R"({"phase":"sweeping","done":100,"total":100,"seconds":0.25})"
                       "\n");
}

TEST_F(ProgressDisplays, AreSilentUnlessAsked) {
  ProgressDisplay display(ProgressDisplay::Targets{}, clock());
  display.report("sweeping", 1, 1);
  display.say("hello");
  EXPECT_EQ(written(), "");
}

TEST_F(ProgressDisplays, AReaderThatWentAwayIsForgotten) {
  ProgressDisplay display({.programs = 987}, clock());  // not open
  display.report("sweeping", 0, 2);
  display.report("sweeping", 2, 2);
}

}  // namespace
}  // namespace pointsweep
