// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class Interrupt : public Tool {
 protected:
  /// Starts a run that would take hours, sends `signal` as soon as its output grows, and gives its status.
  int status_after(int signal) {
    const pid_t child = fork();
    if (child == 0) {
      if (chdir(folder_.c_str()) != 0) _exit(99);
      const int null = open("/dev/null", O_WRONLY);
      dup2(null, STDERR_FILENO);
      execl(POINTSWEEP_TOOL, "pointsweep", "generate", "statue", "out.xyz", "-n", "10G", static_cast<char*>(nullptr));
      _exit(98);
    }
    while (std::filesystem::is_empty(folder_)) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    kill(child, signal);
    int state = 0;
    waitpid(child, &state, 0);
    return WIFEXITED(state) ? WEXITSTATUS(state) : -WTERMSIG(state);
  }
};

TEST_F(Interrupt, CtrlCEndsWithStatus130AndLeavesNothing) {
  EXPECT_EQ(status_after(SIGINT), 130);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(Interrupt, TerminationEndsWithStatus143AndLeavesNothing) {
  EXPECT_EQ(status_after(SIGTERM), 143);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

}  // namespace
}  // namespace pointsweep
