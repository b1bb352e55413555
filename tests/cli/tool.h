// SPDX-License-Identifier: MIT
/// Runs the built tool as a user does, in a separate folder.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/contents.h"

namespace pointsweep {

struct Result {
  int status;  ///< exit status of the process; 128 + number of the signal if a signal ended it
  std::string out, err;
};

class Tool : public testing::Test {
 protected:
  /// Returns the path of the tool in the build folder of this test, quoted for the shell.
  static std::string program() {
    return "'" + (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "../cli/pointsweep").string() + "'";
  }

  Tool() {
    std::string name = (std::filesystem::temp_directory_path() / "pointsweep-cli-test-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~Tool() override { std::filesystem::remove_all(folder_); }

  /// Runs the tool. `arguments` pass through the shell, so they may redirect further descriptors.
  Result tool(const std::string& arguments) { return tool_under("exec", arguments); }
  /// Runs the tool. `how`: shell text that starts the tool, e.g. "ulimit -f 10 && exec".
  Result tool_under(const std::string& how, const std::string& arguments) {
    const std::string command =
        "cd '" + folder_.string() + "' && " + how + " " + program() + " " + arguments + " >.out 2>.err </dev/null";
    const int state = std::system(command.c_str());
    return {WIFEXITED(state) ? WEXITSTATUS(state) : 128 + WTERMSIG(state), contents(folder_ / ".out"),
            contents(folder_ / ".err")};
  }
  /// Runs the tool, expects success, and returns the contents of the file `name`; "" without a name.
  std::string made(const std::string& arguments, const std::string& name = "") {
    const Result result = tool(arguments);
    EXPECT_EQ(result.status, 0) << arguments << "\n" << result.err;
    return name.empty() ? "" : contents(folder_ / name);
  }
  /// Runs the tool, and expects its exit status and an error with `words` on standard error.
  void refused(int status, const std::string& arguments, const std::string& words) {
    const Result result = tool(arguments);
    EXPECT_EQ(result.status, status) << arguments << "\n" << result.err;
    EXPECT_NE(("\n" + result.err).find("\nerror: "), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << arguments << "\n" << result.err;
  }
  void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }
  bool exists(const std::string& name) const { return std::filesystem::exists(folder_ / name); }

  std::filesystem::path folder_;
};

}  // namespace pointsweep
