// SPDX-License-Identifier: MIT
#include "cli/verbs/progress.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

namespace pointsweep {
namespace {

/// A display of progress with a clock that the test moves, and the text that it has written so far.
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
  EXPECT_EQ(written(), "sweeping 25 %, 1.00M of 4.00M points, 200K/s, 0:15 left\n");
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
  EXPECT_EQ(written(), "sweeping 50 %, 50 of 100 points, 10/s, 0:05 left\n");
}

TEST_F(ProgressDisplays, ATerminalGetsABarTenTimesASecondWhichIsTakenAwayAtTheEnd) {
  {
    ProgressDisplay display({.people = pipe_[1], .terminal = true}, clock());
    display.report("writing", 1, 2);
    EXPECT_EQ(written(), "\rwriting    [############------------]  50 %  1 of 2");
    display.report("writing", 1, 2);
    EXPECT_EQ(written(), "");
    wait(0.1);
    display.report("writing", 1, 2);
    EXPECT_NE(written(), "");
  }
  EXPECT_EQ(written(), "\r" + std::string(68, ' ') + "\r");
}

TEST_F(ProgressDisplays, ATerminalOfAnyWidthGetsAWholeLine) {
  constexpr std::uint64_t kTotals[] = {20'000, 4'000'000, 999'499'999, 20'000'000'000'000};
  for (int columns = 1; columns <= 140; ++columns) {
    for (const std::uint64_t total : kTotals) {
      ProgressDisplay display({.people = pipe_[1], .terminal = true, .columns = columns}, clock());
      display.report("generating", 0, total);
      wait(7);
      written();
      display.report("generating", total / 3, total);
      const std::string line = written().substr(1, static_cast<std::size_t>(columns));
      EXPECT_LT(line.find_last_not_of(' ') + 1, static_cast<std::size_t>(columns)) << line;
      const bool is_whole = line.find("33 %") != line.npos && line.find(" 0:14 left") != line.npos;
      EXPECT_TRUE(is_whole || columns < 20) << line;
      EXPECT_EQ(line.find("/s") != line.npos, columns >= 60) << columns << line;
    }
  }
}

TEST_F(ProgressDisplays, AShorterLineTakesALongerOneAway) {
  ProgressDisplay display({.people = pipe_[1], .terminal = true, .columns = 30}, clock());
  display.report("sweeping", 0, 100);
  wait(1);
  display.report("sweeping", 1, 100);
  display.report("sweeping", 100, 100);
  EXPECT_EQ(written(), "\r0 %\r1 %, 1:39 left");
  wait(1);
  display.report("writing", 0, 100);
  EXPECT_EQ(written(), "\r0 %           ");
}

TEST_F(ProgressDisplays, ASentenceTakesThePlaceOfTheBar) {
  ProgressDisplay display({.people = pipe_[1], .terminal = true}, clock());
  display.report("writing", 1, 2);
  written();
  display.say(Severity::warning, "a.las: something is odd");
  EXPECT_EQ(written(), "\r" + std::string(51, ' ') + "\rwarning: a.las: something is odd\n");
}

TEST_F(ProgressDisplays, ProgramsGetTheFirstAndTheLastOfAPhaseAndSomeBetween) {
  ProgressDisplay display({.programs = pipe_[1]}, clock());
  display.report("sweeping", 0, 100);
  wait(0.1);
  display.report("sweeping", 10, 100);
  wait(0.15);
  display.report("sweeping", 20, 100);
  display.report("sweeping", 100, 100);
  display.report("sweeping", 99, 100);  // a late report of another thread
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
  display.say(Severity::note, "hello");
  EXPECT_EQ(written(), "");
}

TEST_F(ProgressDisplays, ThatAreQuietLeaveErrors) {
  ProgressDisplay display({.errors = pipe_[1]}, clock());
  display.say(Severity::warning, "hello");
  display.say(Severity::error, "a.las: no such file");
  EXPECT_EQ(written(), "error: a.las: no such file\n");
}

TEST_F(ProgressDisplays, AReaderThatWentAwayIsForgotten) {
  ProgressDisplay display({.programs = 987}, clock());  // not open
  display.report("sweeping", 0, 2);
  display.report("sweeping", 2, 2);
}

}  // namespace
}  // namespace pointsweep
