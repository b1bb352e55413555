// SPDX-License-Identifier: MIT
/// Completion in shells, and manual pages. Both are made from the declarations of the verbs, so they list what the help
/// lists.
#include <gmock/gmock.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <vector>

#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> lines_in(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

class Completion : public Tool {
 protected:
  /// Runs a shell command in the folder of the test.
  Result shell(const std::string& command) {
    const int state = std::system(("cd '" + folder_.string() + "' && " + command + " >.out 2>.err </dev/null").c_str());
    return {WIFEXITED(state) ? WEXITSTATUS(state) : -1, contents(folder_ / ".out"), contents(folder_ / ".err")};
  }
  bool has_program(const std::string& name) { return shell("command -v " + name).status == 0; }

  /// Returns the completions that bash offers for the last of `words`, which the user is typing.
  std::vector<std::string> offered(const std::vector<std::string>& words) {
    write("script", tool("completion bash").out);
    std::string line = "COMP_WORDS=(pointsweep";
    for (const std::string& word : words) line += " '" + word + "'";
    line += "); COMP_CWORD=" + std::to_string(words.size());
    write("call", "source ./script\n" + line + "\n_pointsweep pointsweep '" + words.back() +
                      "' ''\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n");
    const Result result = shell("bash ./call");
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "");
    std::vector<std::string> lines = lines_in(result.out);
    std::erase(lines, "");
    return lines;
  }

  /// Returns the verbs that the help lists, in its order.
  std::vector<std::string> verbs() {
    std::vector<std::string> names;
    bool found = false;
    for (const std::string& line : lines_in(tool("help").out)) {
      if (found && line.empty()) break;
      if (found) names.push_back(line.substr(2, line.find(' ', 2) - 2));
      found = found || line == "Verbs:";
      std::erase(names, "");
    }
    return names;
  }
  /// Returns the flags that the help of a verb shows: "-k", "--radius", ...
  std::vector<std::string> options_in_help(const std::string& verb) {
    std::vector<std::string> flags;
    for (const std::string& line : lines_in(tool("help " + verb).out)) {
      if (!line.starts_with("  -") || line.starts_with("  - ")) continue;
      std::istringstream words(line);
      for (std::string word; words >> word && word.starts_with('-');) {
        const bool more = word.ends_with(',');
        flags.push_back(more ? word.substr(0, word.size() - 1) : word);
        if (!more) break;
      }
    }
    return flags;
  }
};

TEST_F(Completion, OffersTheVerbsAndTheOptionsOfEachAsTheHelpShowsThem) {
  const std::vector<std::string> all = verbs();
  ASSERT_GT(all.size(), 10u);
  for (const std::string& verb : all) EXPECT_THAT(offered({""}), Contains(verb));
  EXPECT_THAT(offered({"no"}), ElementsAre("normals"));
  for (const std::string& verb : all) {
    std::vector<std::string> flags = offered({verb, "-"}), shown = options_in_help(verb);
    std::ranges::sort(flags), std::ranges::sort(shown);
    EXPECT_FALSE(shown.empty()) << verb;
    EXPECT_EQ(flags, shown) << verb;
  }
}

TEST_F(Completion, OffersValuesOperatorsFoldersAndFiles) {
  write("scan.ply", "");
  write("two words.ply", "");
  std::filesystem::create_directory(folder_ / "there");
  EXPECT_THAT(offered({"normals", "--orient", ""}), ElementsAre("none", "up", "viewpoint", "input"));
  EXPECT_THAT(offered({"normals", "--orient", "=", "u"}), ElementsAre("up"));
  EXPECT_THAT(offered({"run", "--adaptive", "e"}), ElementsAre()) << "no option of this verb";
  EXPECT_THAT(offered({"splats", "--axes", ""}), ElementsAre("auto", "positions", "curvature"));
  EXPECT_THAT(offered({"normals", "-k", ""}), ElementsAre());
  EXPECT_THAT(offered({"normals", "s"}), ElementsAre("scan.ply", "script"));
  EXPECT_THAT(offered({"normals", "scan.ply", "tw"}), ElementsAre("two words.ply"));
  EXPECT_THAT(offered({"normals", "--resume", "t"}), ElementsAre("there"));
  EXPECT_THAT(offered({"operators", "reso"}), ElementsAre("resort"));
  EXPECT_THAT(offered({"run", "--pipeline", "cur"}), ElementsAre("curvature"));
  EXPECT_THAT(offered({"run", "--pipeline", "knn(k=12) | spl"}), ElementsAre("knn(k=12) | splats"));
  EXPECT_THAT(offered({"help", "veri"}), ElementsAre("verify"));
  EXPECT_THAT(offered({"completion", ""}), ElementsAre("bash", "zsh", "fish"));
  EXPECT_THAT(offered({"generate", "sta"}), ElementsAre("statue"));
  EXPECT_THAT(offered({"generate", "statue", "sca"}), ElementsAre("scan.ply"));
  refused(2, "completion tcsh", "'tcsh' is not bash, zsh or fish");
}

TEST_F(Completion, OfZshAndFishNamesEveryVerbAndOptionAndParses) {
  for (const std::string name : {"zsh", "fish"}) {
    const std::string script = tool("completion " + name).out;
    write("script." + name, script);
    for (const std::string& verb : verbs()) {
      EXPECT_THAT(script, HasSubstr(verb)) << name;
      for (const std::string& flag : options_in_help(verb)) {
        const std::string in_fish = flag.starts_with("--") ? " -l " + flag.substr(2) : " -s " + flag.substr(1);
        EXPECT_THAT(script, HasSubstr(name == "zsh" ? ")" + flag + "[" : in_fish)) << verb;
      }
    }
    if (!has_program(name)) continue;
    EXPECT_EQ(shell(name + " -n script." + name).status, 0) << contents(folder_ / ".err");
  }
}

class ManPages : public Completion {};

TEST_F(ManPages, AreWrittenForTheToolAndEveryVerbAndHaveNoErrors) {
  std::filesystem::create_directory(folder_ / "man1");
  made("man --folder man1");
  std::set<std::string> pages;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "man1"))
    pages.insert(entry.path().filename().string());
  std::set<std::string> expected = {"pointsweep.1"};
  for (const std::string& verb : verbs()) expected.insert("pointsweep-" + verb + ".1");
  EXPECT_EQ(pages, expected);
  for (const std::string& page : pages) {
    for (const char c : contents(folder_ / "man1" / page)) ASSERT_LT(static_cast<unsigned char>(c), 128) << page;
    if (!has_program("groff")) continue;
    const Result result = shell("groff -man -ww -Tascii -z man1/" + page);
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.err, "") << page;
  }
  refused(1, "man --folder man1", "exists");
  made("man --folder man1 --force");
  refused(1, "man --folder nowhere", "the folder nowhere does not exist");
}

TEST_F(ManPages, ShowWhatTheHelpShows) {
  if (!has_program("man")) GTEST_SKIP() << "man is not installed";
  for (const std::string& verb : verbs()) {
    write("page.1", tool("man " + verb).out);
    const Result result = shell("env LC_ALL=C.UTF-8 MANWIDTH=200 man --nj --nh --warnings -l page.1");
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(result.err, "") << verb;
    EXPECT_THAT(result.out, HasSubstr("pointsweep-" + verb + " - "));
    for (const std::string& flag : options_in_help(verb)) EXPECT_THAT(result.out, HasSubstr(flag)) << verb;
  }
  EXPECT_TRUE(tool("man").out.starts_with(".TH POINTSWEEP "));
  refused(2, "man norml", "Did you mean 'normals'?");
}

}  // namespace
}  // namespace pointsweep
