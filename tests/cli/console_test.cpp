// SPDX-License-Identifier: MIT
/// Standard output and standard error may be closed, full or without a reader. No verb then aborts, changes its exit
/// status or writes its text into another file.
#include "cli/console/console.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <sstream>
#include <vector>

#include "cli/tool.h"
#include "tests/cli/every_verb.h"
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

enum class Fate { kept, closed_pipe, full, closed };
constexpr Fate kFates[] = {Fate::closed_pipe, Fate::full, Fate::closed};

void suffer(int descriptor, Fate fate) {
  int ends[2];
  switch (fate) {
    case Fate::kept:
      dup2(open(descriptor == STDOUT_FILENO ? ".out" : ".err", O_WRONLY | O_CREAT | O_TRUNC, 0666), descriptor);
      return;
    case Fate::closed_pipe:
      if (pipe(ends) == 0) dup2(ends[1], descriptor), close(ends[0]);
      return;
    case Fate::full:
      dup2(open("/dev/full", O_WRONLY), descriptor);
      return;
    case Fate::closed:
      close(descriptor);
      return;
  }
}

class Console : public Tool {
 protected:
  /// Returns the exit status of the tool. The tool runs in a fork of this process, which takes a tenth of the time of a
  /// new process.
  int status(std::vector<std::string> words, Fate out, Fate err) {
    words.insert(words.begin(), "pointsweep");
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    const pid_t child = fork();
    if (child == 0) {
      if (chdir(folder_.c_str()) != 0) _exit(255);
      if (out != Fate::closed) suffer(STDOUT_FILENO, out);
      suffer(STDERR_FILENO, err);
      if (out == Fate::closed) close(STDOUT_FILENO);  // last, since another file would take its number
      _exit(run_tool(static_cast<int>(words.size()), arguments.data()));
    }
    int state = 0;
    waitpid(child, &state, 0);
    return WIFEXITED(state) ? WEXITSTATUS(state) : 128 + WTERMSIG(state);
  }

  int status_in_shell(const std::string& arguments) {
    const std::string command = "cd '" + folder_.string() + "' && exec " + program() + " " + arguments;
    return WEXITSTATUS(std::system(command.c_str()));
  }

  /// Expects that status 0 becomes 1 if a text cannot be written to a full standard output, and that no other status
  /// changes.
  void expect_own_status(const std::vector<std::string>& words) {
    const int right = status(words, Fate::kept, Fate::kept);
    const bool prints = !contents(folder_ / ".out").empty();
    for (const Fate fate : kFates) {
      EXPECT_EQ(status(words, fate, Fate::kept), right == 0 && prints && fate == Fate::full ? 1 : right);
      EXPECT_EQ(status(words, Fate::kept, fate), right);
    }
  }
};

TEST_F(Console, NoFateOfItChangesTheStatusOfAVerb) {
  for (const std::string& verb : every_verb()) {
    SCOPED_TRACE(verb);
    expect_own_status({verb, "--help"});
    expect_own_status({verb, "nofile.ply", "out.ply"});
    expect_own_status({verb, "--no-such-option"});
  }
  for (const char* word : {"--version", "--help", "nonsense"}) expect_own_status({word});
}

TEST_F(Console, NoFateOfItChangesARun) {
  made("generate sphere scan.ply -n 100");
  made("normals scan.ply right.ply --no-provenance");
  for (const char* fate : {">/dev/full", ">&-", "2>/dev/full", "2>&-", ">&- 2>&-"}) {
    SCOPED_TRACE(fate);
    EXPECT_EQ(status_in_shell(std::string("normals scan.ply out.ply --force --no-provenance >.out 2>.err ") + fate), 0);
    EXPECT_TRUE(contents(folder_ / "out.ply") == contents(folder_ / "right.ply"));
  }
}

TEST_F(Console, NoFileGetsTheNumberOfAClosedDescriptor) {
  for (const int closed : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    const pid_t child = fork();
    if (child == 0) {
      close(closed);
      open_console();
      _exit(open("/dev/null", O_RDONLY) > STDERR_FILENO ? 0 : 1);
    }
    int state = 0;
    waitpid(child, &state, 0);
    EXPECT_TRUE(WIFEXITED(state) && WEXITSTATUS(state) == 0) << closed;
  }
}

TEST_F(Console, AFullStandardOutputIsAnErrorInOneSentence) {
  EXPECT_EQ(status({"operators"}, Fate::full, Fate::kept), 1);
  EXPECT_EQ(contents(folder_ / ".err"),
            "error: standard output cannot be written: No space left on device; redirect it to another place.\n");
}

TEST_F(Console, AClosedOneIsSilent) {
  for (const Fate fate : {Fate::closed_pipe, Fate::closed}) {
    EXPECT_EQ(status({"operators"}, fate, Fate::kept), 0);
    EXPECT_EQ(contents(folder_ / ".err"), "");
  }
}

TEST_F(Console, PointsForAClosedStandardOutputAreAnError) {
  made("generate sphere scan.ply -n 100");
  for (const char* fate : {">&-", ">/dev/full"}) {
    EXPECT_EQ(status_in_shell(std::string("sort scan.ply - 2>.err ") + fate), 1);
    EXPECT_TRUE(contents(folder_ / ".err").starts_with("error: -: ")) << contents(folder_ / ".err");
  }
}

/// Returns the severities of the lines on standard error, in their order.
std::vector<std::string> severities_of(const Result& result) {
  std::istringstream text(result.err);
  std::vector<std::string> found;
  for (std::string line; std::getline(text, line);) found.push_back(line.substr(0, line.find(':')));
  return found;
}

TEST_F(Console, SentencesBeginWithTheirSeverity) {
  made("generate sphere scan.ply -n 100");
  std::filesystem::create_directory(folder_ / "tiles");
  std::filesystem::copy(folder_ / "scan.ply", folder_ / "tiles");
  write("tiles/notes.txt", "no points");
  const auto severities = [&](const std::string& command) { return severities_of(tool(command)); };
  using Severities = std::vector<std::string>;
  // A file is left out, normals are replaced, and a file is written.
  EXPECT_EQ(severities("normals tiles/ out.ply"), (Severities{"note", "warning", "note"}));
  EXPECT_EQ(severities("run scan.ply no.ply --pipeline 'where(x > 5)'"), (Severities{"warning", "note"}));
  EXPECT_EQ(severities("info tiles/ nofile.ply --quiet"), (Severities{"error", "error"}));
  EXPECT_EQ(severities("sort scan.ply out.ply"), (Severities{"error"}));
}

/// Returns the text that a terminal gets as standard error of the command.
std::string terminal_gets(int terminal, const std::string& command) {
  const int kept_open = open(ptsname(terminal), O_RDWR | O_NOCTTY);  // keeps the text after the tool ends
  EXPECT_EQ(std::system((command + " 2>" + ptsname(terminal)).c_str()), 0);
  std::string text;
  char buffer[4096];
  for (ssize_t got; (got = read(terminal, buffer, sizeof buffer)) > 0;)
    text.append(buffer, static_cast<std::size_t>(got));
  close(kept_open);
  return text;
}

TEST_F(Console, ATerminalGetsNoEscapeSequence) {
  const int master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0)
    GTEST_SKIP() << "this system gives no pseudo-terminal";
  made("generate sphere scan.ply -n 100");
  const std::string command = program() + " sort scan.ply out.ply --force";
  for (const std::string terminal : {"TERM=dumb", "TERM=xterm NO_COLOR=1", "TERM=xterm"}) {
    const std::string text = terminal_gets(master, "cd '" + folder_.string() + "' && " + terminal + " " + command);
    EXPECT_NE(text.find("wrote out.ply"), text.npos) << terminal << text;
    EXPECT_EQ(text.find('\x1b'), text.npos) << terminal << text;
    EXPECT_EQ(text.find('%') != text.npos, terminal != "TERM=dumb") << terminal << text;
  }
  close(master);
}

}  // namespace
}  // namespace pointsweep
