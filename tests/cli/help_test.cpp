// SPDX-License-Identifier: MIT
/// The texts for a new user: help, version, suggestions for misspelt names, and examples that run as pasted.
#include "cli/text/help.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "cli/text/operator_listing.h"
#include "cli/verbs/commands.h"
#include "pointsweep/program/pipeline.h"
#include "pointsweep/program/run_options.h"
#include "pointsweep/reader.h"
#include "tests/cli/every_verb.h"
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

using Help = Tool;

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// Returns the number of characters of a line in UTF-8.
std::size_t columns_of(const std::string& line) {
  std::size_t columns = 0;
  for (const char c : line) columns += (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  return columns;
}

/// Returns the lines of `text` that begin with two blanks and `word`, without the word.
std::vector<std::string> lines_after(const std::string& text, const std::string& word) {
  std::vector<std::string> found;
  for (const std::string& line : lines_of(text))
    if (line.starts_with("  " + word + " ")) found.push_back(line.substr(line.find_first_not_of(' ', word.size() + 2)));
  return found;
}

TEST_F(Help, OfEveryVerbFitsAHundredColumns) {
  for (const std::string& verb : every_verb()) {
    const Result result = tool(verb + " --help");
    EXPECT_EQ(result.status, 0);
    for (const std::string& line : lines_of(result.out)) EXPECT_LE(columns_of(line), 100u) << verb << "\n" << line;
  }
  for (const char* command : {"--help", "operators"})
    for (const std::string& line : lines_of(tool(command).out)) EXPECT_LE(columns_of(line), 100u) << line;
}

/// Returns whether `line` has room for the first word of `next`.
bool is_broken_early(const std::string& line, const std::string& next) {
  const std::size_t begin = next.find_first_not_of(' '), end = std::min(next.find(' ', begin), next.size());
  return columns_of(line) + 1 + columns_of(next.substr(begin, end - begin)) <= 80;
}

TEST_F(Help, IsWrappedOnce) {
  for (const std::string& verb : every_verb()) {
    const std::vector<std::string> lines = lines_of(tool("help " + verb).out);
    for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
      const std::size_t indent = lines[i].find_first_not_of(' '), below = lines[i + 1].find_first_not_of(' ');
      const bool one_paragraph = indent == below && (indent == 0 || indent == 30) && !lines[i].ends_with(':');
      EXPECT_FALSE(one_paragraph && is_broken_early(lines[i], lines[i + 1])) << verb << "\n" << lines[i];
    }
  }
}

/// A line of a formula that ends amid a sentence would be wrapped again.
TEST_F(Help, LinesOfFormulasAreWhole) {
  for (const ListedOperator& listed : listed_operators({})) {
    const std::vector<std::string> lines = lines_of(listed.declaration.formula);
    for (std::size_t i = 0; i + 1 < lines.size(); ++i) {
      const std::string word = lines[i + 1].substr(0, lines[i + 1].find(' '));
      const bool is_plain_word = std::ranges::all_of(word, [](char c) { return c >= 'a' && c <= 'z'; });
      EXPECT_TRUE(!is_plain_word || lines[i].ends_with('.') || lines[i].ends_with(';')) << lines[i];
    }
  }
}

/// Returns the names of the options of every verb.
std::map<std::string, std::vector<std::string>> options_of_verbs(const CLI::App& app) {
  std::map<std::string, std::vector<std::string>> options;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    for (const CLI::Option* option : verb->get_options()) options[verb->get_name()].push_back(option->get_name());
  return options;
}

TEST_F(Help, AVerbAloneHasItsOptionsAndTheOthersTheirNames) {
  CLI::App all;
  add_verbs(all);
  const auto of_all = options_of_verbs(all);
  EXPECT_GE(of_all.size(), 23u);
  for (const auto& [name, options] : of_all) {
    CLI::App one;
    add_verbs(one, name);
    const auto of_one = options_of_verbs(one);
    EXPECT_EQ(of_one.at(name), options) << name;
    EXPECT_EQ(of_one.size(), of_all.size()) << name;
    if (name == "help" || name == "completion" || name == "man")
      EXPECT_EQ(of_one, of_all) << name;
    else
      EXPECT_EQ(of_one.at(name == "info" ? "normals" : "info"), std::vector<std::string>{"--help"}) << name;
  }
}

TEST_F(Help, FlagsOfAVerbStandInGroups) {
  CLI::App app;
  add_verbs(app);
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    for (const CLI::Option* option : verb->get_options())
      EXPECT_TRUE(!option->nonpositional() || option->get_group().empty() ||
                  std::ranges::find(kGroups, option->get_group()) != std::end(kGroups))
          << option->get_name();
  const std::string help = tool("help normals").out;
  std::size_t at = 0;
  for (const std::string group : kGroups) {
    const std::size_t next = help.find("\n\n" + group + ":\n", at);
    ASSERT_NE(next, help.npos) << group << "\n" << help;
    at = next;
  }
  EXPECT_LT(help.find("\nOutput:"), help.find("--output FILE"));
  EXPECT_LT(help.find("--output FILE"), help.find("\nMemory and machine:"));
}

TEST_F(Help, OfAnOperatorIsItsListing) {
  for (const ListedOperator& listed : listed_operators({})) {
    const std::string text = help_of_operator(listed.declaration.name);
    EXPECT_TRUE(text.starts_with(listed.declaration.name + ": ")) << text;
    EXPECT_NE(text.find("Usage: pointsweep run IN... OUT --pipeline '"), std::string::npos) << text;
  }
  const std::string voxel = tool("help voxel").out;
  EXPECT_TRUE(voxel.starts_with("voxel: keeps one point in each cube")) << voxel;
  EXPECT_EQ(made("voxel"), "");
  EXPECT_EQ(tool("voxel").out, voxel);
  refused(2, "voxel a.ply b.ply", "'voxel' is an operator, not a verb: pointsweep run IN... OUT --pipeline '");
}

TEST_F(Help, NoBudgetIsZeroMegabytes) {
  made("generate sphere in.ply -n 100");
  for (const char* size : {"1B", "500K", "1023K", "1M"}) {
    const Result result = tool(std::string("normals in.ply out.ply --memory ") + size);
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.err.find(" 0 MB"), std::string::npos) << result.err;
  }
}

TEST_F(Help, IsTheSameByVerbAndByOption) {
  EXPECT_EQ(tool("help").out, tool("--help").out);
  for (const std::string& verb : every_verb()) {
    const Result result = tool("help " + verb);
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.out, tool(verb + " --help").out);
    EXPECT_NE(result.out.find("Usage: pointsweep " + verb), std::string::npos) << result.out;
  }
  refused(2, "help nieghbors", "'nieghbors' is not a verb. Did you mean 'neighbors'?");
}

TEST_F(Help, OfAVerbDoesNotRepeatThatOfTheTool) {
  for (const std::string& verb : every_verb())
    EXPECT_EQ(tool("help " + verb).out.find("explains a verb"), std::string::npos) << verb;
}

TEST_F(Help, IsShownWhereNoVerbIsGiven) {
  const Result result = tool("");
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err, "error: name a verb, as in the example below.\n\n" + tool("--help").out + "\n");
}

TEST_F(Help, NamesTheVerbThatWasProbablyMeant) {
  refused(2, "norml a b", "'norml' is not a verb. Did you mean 'normals'?");
  refused(2, "Normals a b", "Did you mean 'normals'?");
  refused(2, "neigh a b", "Did you mean 'neighbors'?");
  const Result far = tool("triangulate a b");
  EXPECT_NE(far.err.find("'triangulate' is not a verb.\nRun 'pointsweep help' for help."), std::string::npos)
      << far.err;
}

TEST_F(Help, NamesTheOptionThatWasProbablyMeant) {
  refused(2, "normals a.ply b.ply --theads 3", "'--theads' is not an option of this verb. Did you mean '--threads'?");
  refused(2, "normals a.ply b.ply --mem=2G", "'--mem' is not an option of this verb. Did you mean '--memory'?");
  refused(2, "sort a.ply b.ply --aixs x", "Did you mean '--axis'?");
  refused(2, "fair a.ply b.ply --orientation up", "fair: '--orientation'");
  const Result far = tool("normals a.ply b.ply --transparency 3");
  EXPECT_EQ(far.err.find("Did you mean"), std::string::npos) << far.err;
  EXPECT_NE(far.err.find("Run 'pointsweep help normals' for help."), std::string::npos) << far.err;
  refused(2, "--quiet normals a.ply b.ply", "'--quiet' comes before the verb");
  refused(2, "generate sphere a.ply b.ply -n 3", "'b.ply' is one argument too many");
  refused(2, "normals a.ply b.ply --radius", "--radius needs a value");
}

TEST_F(Help, VersionTellsBuildInstructionSetAndFormats) {
  const Result result = tool("--version");
  EXPECT_EQ(result.status, 0);
  EXPECT_TRUE(result.out.starts_with("pointsweep ")) << result.out;
  for (const char* words : {"\n  build ", "\n  instruction set ", "\n  reads ", "PLY, LAS, ", "QSplat, text",
                            "\n  writes ", ".ply, .las", "\n  codecs "})
    EXPECT_NE(result.out.find(words), std::string::npos) << words << "\n" << result.out;
  EXPECT_EQ(result.out.find("LASzip"), result.out.rfind("LASzip")) << result.out;
  EXPECT_NE(result.out.find("GCC") + result.out.find("Clang"), 2 * std::string::npos);
}

/// Returns whether the verb writes a file that may exist.
bool takes_force(const std::string& help) { return help.find("--force") != std::string::npos; }

TEST_F(Help, ExamplesRunAsPasted) {
  made("generate statue scan.ply -n 4000 --noise 0.002", "scan.ply");
  for (const char* tile : {"tile_1", "tile_2"}) made(std::string("generate sphere -n 900 -o ") + tile + ".las");
  made("convert scan.ply scan.las");
  for (const char* name : {"tiles", "scans", "lines", "survey", "delivery"}) {
    std::filesystem::create_directory(folder_ / name);
    std::filesystem::copy(folder_ / "tile_1.las", folder_ / name);
  }
  write("registration.txt", "0 -1 0 5\n1 0 0 2\n0 0 1 0\n0 0 0 1\n");
  for (const std::string& verb : every_verb()) {
    if (verb == "verify" || verb == "render") {  // their examples read outputs of other verbs
      made("normals scan.ply normals.ply -k 12 --force");
      made("run scan.ply out.las --pipeline 'knn(k=12) | normals(orient=up)' --force");
      made("run scan.ply splats.ply --pipeline 'normals | curvature | splats' --force");
    }
    const std::string help = tool("help " + verb).out;
    const auto examples = lines_after(help, "pointsweep");
    EXPECT_FALSE(examples.empty()) << verb;
    for (const std::string& example : examples) {
      const Result result = tool(example + (takes_force(help) ? " --force" : ""));
      EXPECT_EQ(result.status, 0) << example << "\n" << result.err;
    }
  }
  for (const std::string& example : lines_after(tool("help").out, "pointsweep"))
    EXPECT_EQ(tool(example + " --force").status, 0) << example;
}

TEST_F(Help, EveryOptionOfRunsIsAFlagOfRun) {
  const std::string help = tool("help run").out;
  for (const RunOption& option : run_options()) {
    const std::string& flag = option.flag.substr(option.flag.find("--"));
    EXPECT_NE(help.find(flag + (option.value.empty() ? "" : " " + option.value)), std::string::npos) << flag;
  }
}

TEST_F(Help, ExamplesOfOperatorsArePipelinesThatRun) {
  made("generate statue in.ply -n 3000 --noise 0.002", "in.ply");
  for (const char* other : {"before.las", "after.las", "labelled.las"})  // files with which examples compare
    made(std::string("generate statue ") + other + " -n 3000 --noise 0.01");
  const auto operators = nlohmann::json::parse(tool("operators --json").out);
  EXPECT_EQ(operators.size(), all_operators().size() + 1) << "and knn";
  for (const auto& listed : operators) {
    const std::string example = listed["example"];
    EXPECT_EQ(tool("run in.ply out.ply --force --pipeline '" + example + "'").status, 0) << example;
  }
}

TEST_F(Help, AViewpointIsDocumentedAsItIsParsed) {
  made("generate statue in.ply -n 1000", "in.ply");
  const std::string listing = tool("operators normals").out;
  EXPECT_NE(listing.find("viewpoint      [X,Y,Z]: "), std::string::npos) << listing;
  EXPECT_EQ(made("run in.ply a.ply --pipeline 'normals(orient=viewpoint, viewpoint=[3,0,0.5])'", "a.ply"),
            made("normals in.ply b.ply --orient viewpoint --viewpoint 3,0,0.5", "b.ply"));
  refused(2, "run in.ply c.ply --pipeline 'normals(orient=viewpoint, viewpoint=3)'", "three numbers [X,Y,Z], not '3'");
}

TEST_F(Help, AnUnknownOperatorIsNamedBeforeItsOptions) {
  made("generate statue in.ply -n 1000", "in.ply");
  refused(2, "run in.ply c.ply --pipeline 'normals | spalts(0.1)'", "column 11: no operator is called 'spalts'");
  refused(2, "run in.ply c.ply --pipeline 'normals | spalts(0.1)'", "the nearest is 'splats'");
  refused(2, "run in.ply c.ply --pipeline 'soften(0.1)'", "no operator is called 'soften'; 'pointsweep operators'");
  refused(2, "run in.ply c.ply --pipeline 'thin(0.1)'", "no operator is called 'thin'; 'voxel', 'poisson'");
  refused(2, "run in.ply c.ply --pipeline 'knn(8) | thin([1,2])'", "no operator is called 'thin'");
  refused(2, "run in.ply c.ply --pipeline 'knn(8, 3) | normals'",
          "column 8: knn: '3' has no name; write options as NAME=VALUE, e.g. k=3");
  refused(2, "run in.ply c.ply --pipeline 'normals(k=8)'", "k belongs to the neighbourhood: write knn(k=8) | normals");
  refused(2, "run in.ply c.ply --pipeline 'reproject(EPSG)'", "pointsweep does not reproject coordinates, but 'pdal");
  write("stages.txt", "normals");
  refused(2, "run in.ply c.ply --pipeline stages.txt", "stages.txt: pipeline files end in .json");
  refused(2, "merge in.ply c.ply", "'merge' is not a verb; 'pointsweep convert IN... OUT' does it");
  refused(2, "run in.ply c.ply --pipeline 'normals(orient)'", "the option 'orient' has no value; write orient=VALUE");
  refused(2, "run in.ply c.ply --pipeline 'curvature(3)'", "curvature has no options");
  refused(2, "run in.ply c.ply --pipeline 'normals(oreint=up)'", "normals has no option 'oreint'; the nearest");
}

std::string in_one_line(const std::string& text) {
  std::istringstream words(text);
  std::string line;
  for (std::string word; words >> word;) line += word + " ";
  return line;
}

TEST_F(Help, UsesTheWordsOfANewUser) {
  const std::string normals = in_one_line(tool("help normals").out), fair = tool("help fair").out;
  for (const char* words : {"Number of neighbours, excluding the point", "How to orient normals",
                            "Rerun the command to resume", "Print errors only", "Input files (merged), then output"})
    EXPECT_NE(normals.find(words), std::string::npos) << words;
  EXPECT_NE(fair.find("edge-preserving"), std::string::npos);
}

TEST_F(Help, AWarningExplainsResultsThatAreUndefined) {
  write("line.xyz", "0 0 0\n1 0 0\n2 0 0\n3 0 0\n");
  const Result result = tool("normals line.xyz out.ply");
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.err.find("warning: normals: 4 points have too few neighbours, or only neighbours on a line; their "
                            "normals are 0 (--stats FILE lists the rows).\n"),
            std::string::npos)
      << result.err;
  EXPECT_NE(tool("normals line.xyz out.ply -f --stats s.json").err.find("degenerate_rows in s.json lists the rows"),
            std::string::npos);
}

}  // namespace
}  // namespace pointsweep
