// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>
#include <vector>

#include "cli/verbs/commands.h"
#include "tests/cli/every_verb.h"
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

using Usage = Tool;

TEST_F(Usage, HelpNamesEveryVerb) {
  const Result result = tool("--help");
  EXPECT_EQ(result.status, 0);
  for (const std::string& verb : every_verb())
    EXPECT_NE(result.out.find("\n  " + verb + " "), std::string::npos) << result.out;
}

TEST_F(Usage, HelpOfEveryVerbEndsWithAnExample) {
  for (const std::string& verb : every_verb()) {
    const Result result = tool(verb + " --help");
    EXPECT_EQ(result.status, 0);
    const auto example = result.out.find("\nExample");
    ASSERT_NE(example, std::string::npos) << verb;
    EXPECT_NE(result.out.find("\n  pointsweep " + verb + " ", example), std::string::npos) << result.out;
  }
}

TEST_F(Usage, NonsenseIsStatus2) {
  refused(2, "norml a b", "'norml' is not a verb");
  refused(2, "normals a.ply", "IN... OUT");
  refused(2, "sort", "IN... OUT");
  refused(2, "normals a.ply b.ply --colour", "--colour");
  refused(2, "sort a.ply b.ply --axis w", "'w' is not auto, x, y or z");
  refused(2, "normals a.ply b.ply --order random", "'random' is not input or sweep");
  refused(2, "normals a.ply b.ply --memory lots", "'lots' is not a size");
  refused(2, "normals a.ply b.ply --orient sideways", "'sideways'");
  refused(2, "normals a.ply b.ply --orient viewpoint --viewpoint 1,2", "X,Y,Z");
  refused(2, "normals a.ply b.ply --orient viewpoint", "add --viewpoint X,Y,Z");
  refused(2, "normals a.ply b.ply --orient viewpoint 0,0,1.7", "add --viewpoint X,Y,Z");
  refused(2, "normals a.ply b.ply --viewpoint 0,0,1.7", "viewpoint is used only with orient=viewpoint");
  refused(2, "neighbors a.ply b.npy -k 0", "k is a whole number, 1 or more, not '0'");
  refused(2, "normals a.ply b.ply -k -1", "-k: knn: k is a whole number, 1 or more, not '-1'");
}

TEST_F(Usage, TheLastOfSeveralFilesIsNotReplacedWhenTheOutputWasForgotten) {
  for (const char* name : {"tile_1", "tile_2", "tile_3"})
    ASSERT_EQ(tool(std::string("generate sphere ") + name + ".las -n 500").status, 0);
  const std::string last = contents(folder_ / "tile_3.las");
  for (const char* verb :
       {"normals", "sort", "curvature", "splats", "fair", "ground", "thin --decimate 1", "run --pipeline normals"})
    for (const char* force : {"", " -f"})
      refused(2, std::string(verb) + " tile_*.las" + force, "tile_3.las: exists, and as the last of 3 files");
  write("z.png", "precious"), write("z.npy", "precious");
  refused(2, "render tile_*.las z.png -f", "-o FILE");
  refused(2, "neighbors tile_*.las z.npy -f", "-o FILE");
  refused(2, "normals tile_1.las -f", "IN... OUT");
  EXPECT_EQ(contents(folder_ / "tile_3.las"), last);
  EXPECT_EQ(contents(folder_ / "z.png") + contents(folder_ / "z.npy"), "preciousprecious");
}

TEST_F(Usage, OutputNamesTheFileToWriteForEveryVerb) {
  for (const char* name : {"a", "b", "c"})
    ASSERT_EQ(tool(std::string("generate sphere -n 500 --output ") + name + ".ply").status, 0);
  for (const char* verb :
       {"normals", "sort", "curvature", "splats", "fair", "ground", "thin --decimate 1", "run --pipeline normals"}) {
    EXPECT_EQ(tool(std::string(verb) + " -o out.ply ?.ply -f").status, 0) << verb;
    EXPECT_NE(tool("info out.ply").out.find("points      1500"), std::string::npos) << verb;
    EXPECT_EQ(tool(std::string(verb) + " a.ply b.ply --output out.ply -f").status, 0) << verb;
    EXPECT_NE(tool("info out.ply").out.find("points      1000"), std::string::npos) << verb;
  }
  EXPECT_EQ(tool("neighbors a.ply b.ply -o out.npy").status, 0);
  EXPECT_EQ(tool("neighbors a.ply b.ply -o out.npy -f").status, 0);
  EXPECT_EQ(tool("render a.ply b.ply -o out.png").status, 0);
  EXPECT_EQ(tool("run a.ply b.ply -o dry.ply --pipeline normals --dry-run").status, 0);
  EXPECT_FALSE(exists("dry.ply"));
  refused(2, "normals -o out.ply", "IN... OUT");
  refused(2, "generate sphere -n 5", "OUT");
  refused(2, "generate sphere x.ply -o y.ply -n 5", "OUT");
}

TEST_F(Usage, AnInputIsNeverAnOutputWhateverLinksLeadToIt) {
  ASSERT_EQ(tool("generate sphere in.ply -n 500").status, 0);
  namespace fs = std::filesystem;
  const std::string before = contents(folder_ / "in.ply");
  fs::create_symlink("in.ply", folder_ / "link.ply");
  fs::create_hard_link(folder_ / "in.ply", folder_ / "hard.ply");
  fs::create_directory_symlink(".", folder_ / "folder");
  fs::create_directory(folder_ / "sub");
  write("chain.json", "[{\"type\": \"normals\"}]");
  for (const std::string out : {"in.ply", "./in.ply", "link.ply", "hard.ply", "folder/in.ply", "sub/../in.ply"}) {
    for (const char* verb : {"normals in.ply ", "sort in.ply ", "run --pipeline normals link.ply ", "fair hard.ply ",
                             "render folder/in.ply ", "splats folder/in.ply -o "})
      refused(2, verb + out + " -f", "is an input");
    refused(2, "normals in.ply out.ply -f --stats " + out, "is an input");
    refused(2, "normals in.ply out.ply -f --report " + out, "is an input");
    refused(2, "neighbors in.ply out.npy -f --distances " + out, "is an input");
    refused(2, "run in.ply " + out + " -f --pipeline normals --dry-run", "is an input");
  }
  refused(2, "normals in.ply -f -o /proc/self/fd/7 7<in.ply", "is an input");
  refused(2, "normals /proc/self/fd/7 in.ply -f 7<in.ply", "is an input");
  refused(2, "run in.ply out.ply --pipeline chain.json --stats chain.json -f", "is an input");
  EXPECT_EQ(contents(folder_ / "in.ply"), before);
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.ply"));
  EXPECT_FALSE(exists("out.ply"));
}

TEST_F(Usage, TwoOutputsAreNotOneFile) {
  ASSERT_EQ(tool("generate sphere in.ply -n 500").status, 0);
  std::filesystem::create_directory_symlink(".", folder_ / "folder");
  refused(2, "normals in.ply out.ply --stats folder/out.ply", "two outputs");
  refused(2, "normals in.ply out.ply --report out.ply", "two outputs");
  refused(2, "normals in.ply out.ply --stats s --report ./s", "two outputs");
  refused(2, "neighbors in.ply out.npy --distances folder/out.npy", "two outputs");
  refused(2, "neighbors in.ply out.npy --distances d.npy --stats d.npy", "two outputs");
  write("s", "old");
  refused(2, "normals in.ply out.ply -f --stats s --report folder/s", "two outputs");
  EXPECT_EQ(contents(folder_ / "s"), "old");
}

/// Expects that the parser refuses the command line "VERB FLAG ''", or "VERB ''" for an argument.
void expect_no_empty_value(const std::string& verb, const std::string& flag) {
  CLI::App app;
  add_verbs(app);
  std::vector<std::string> words = {"", verb};  // from the last to the first
  if (!flag.empty()) words.insert(words.begin() + 1, flag);
  try {
    app.parse(words);
    ADD_FAILURE() << verb << " " << flag;
  } catch (const CLI::ParseError& error) {
    const std::string sentence = error.what();
    EXPECT_TRUE(sentence.find("the value is empty") != std::string::npos ||
                sentence.find("not in range") != std::string::npos)
        << verb << " " << flag << ": " << sentence;
  }
}

TEST_F(Usage, NoOptionOfAnyVerbTakesAnEmptyValue) {
  CLI::App app;
  add_verbs(app);
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    for (const CLI::Option* option : verb->get_options())
      if (option->get_items_expected_max() > 0)
        expect_no_empty_value(verb->get_name(), option->nonpositional() ? option->get_name() : "");
}

TEST_F(Usage, AnEmptyNameIsNoFolderOfOutputs) {
  write("in.xyz", "1 2 3\n");
  for (const char* files : {"in.xyz ''", "in.xyz -o ''", "'' out.ply", "in.xyz '' out.ply"})
    refused(2, std::string("sort ") + files, "the value is empty; give one, or leave the option out");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 3) << "in.xyz, .out and .err";
}

TEST_F(Usage, AMissingInputIsStatus1) {
  refused(1, "normals a.ply b.ply", "a.ply");
  refused(1, "sort a.ply b.ply", "a.ply");
  refused(1, "neighbors a.ply b.npy", "a.ply");
}

TEST_F(Usage, StandardOutputThatIsFullIsAnError) {
  write("a.xyz", "0 0 0\n");
  const Result result = tool("info a.xyz 2>.err >/dev/full #");
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("standard output"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace pointsweep
