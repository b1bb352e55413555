// SPDX-License-Identifier: MIT
/// The extension of its name decides the format of an output, for every verb that writes points.
#include <CLI/CLI.hpp>
#include <map>
#include <set>

#include "cli/verbs/commands.h"
#include "pointsweep/formats/registry.h"
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class OutputName : public Tool {
 protected:
  OutputName() { made("generate terrain in.ply -n 300"); }

  static bool is_copc(const std::string& file) { return file.size() > 589 && file.substr(377, 4) == "copc"; }
};

TEST_F(OutputName, OfCopcGivesLevelsByEveryVerbThatWritesPoints) {
  const std::map<std::string, std::string> others = {
      {"run", " --pipeline normals"}, {"thin", " --voxel 1"}, {"transform", " --translate 1,2,3"}};
  // Verbs that write arrays, pictures or many files, that take other inputs, or that need an order that COPC does not
  // have.
  const std::set<std::string> of_other_files = {"neighbors", "render", "generate", "split", "tile", "sort"};
  const auto has_output = [](const CLI::App* verb) { return verb->get_option_no_throw("-o") != nullptr; };
  CLI::App app;
  add_verbs(app);
  std::size_t verbs = 0;
  for (const CLI::App* verb : app.get_subcommands(has_output)) {
    if (of_other_files.contains(verb->get_name())) continue;
    ++verbs;
    const auto other = others.find(verb->get_name());
    const std::string output = verb->get_name() + ".Copc.LAZ";
    made(verb->get_name() + " in.ply -o " + output + (other == others.end() ? "" : other->second), output);
    EXPECT_TRUE(is_copc(contents(folder_ / output))) << verb->get_name();
  }
  EXPECT_GE(verbs, 6u);
}

TEST_F(OutputName, OfCopcWhereverElseItIsGiven) {
  EXPECT_TRUE(is_copc(made("generate terrain a.copc.laz -n 9", "a.copc.laz")));
  EXPECT_TRUE(is_copc(made("run in.ply -o out/ --output-format copc.laz --pipeline normals", "out/in.copc.laz")));
  EXPECT_TRUE(is_copc(made("convert out/ again/", "again/in.copc.laz")));
  EXPECT_FALSE(is_copc(made("convert out/ plain/ --output-format laz", "plain/in.laz")));
  EXPECT_TRUE(is_copc(made("tile in.ply tiles/ --size 2000 --output-format .copc.laz", "tiles/0_0.copc.laz")));
}

TEST_F(OutputName, TellsTheExtensionOfTwoParts) {
  EXPECT_EQ(extension_of("tiles/a.Copc.Laz"), ".copc.laz");
  EXPECT_EQ(extension_of("copc.laz"), ".laz");
  EXPECT_EQ(extension_of(".copc.laz"), ".laz");
  EXPECT_EQ(extension_of("a.copc.las"), ".las");
}

}  // namespace
}  // namespace pointsweep
