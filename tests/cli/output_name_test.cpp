// SPDX-License-Identifier: MIT
/// Names by which programs expect a format that is not written; formats and verbs are those of the registries.
#include <CLI/CLI.hpp>
#include <cctype>
#include <map>
#include <set>

#include "cli/verbs/commands.h"
#include "pointsweep/error.h"
#include "pointsweep/formats/registry.h"
#include "tests/cli/tool.h"

namespace pointsweep {
namespace {

class OutputName : public Tool {
 protected:
  OutputName() { made("generate terrain in.ply -n 300"); }

  static std::vector<const Format*> formats_with_refused_names() {
    std::vector<const Format*> some;
    for (const Format* format : formats())
      if (!format->refused_ending.empty()) some.push_back(format);
    return some;
  }
};

TEST_F(OutputName, OfAFormatThatIsNotWrittenIsRefusedByEveryVerbThatWritesPoints) {
  const std::map<std::string, std::string> others = {{"run", " --pipeline normals"},
                                                     {"split", " --by classification"},
                                                     {"thin", " --voxel 1"},
                                                     {"tile", " --size 1"},
                                                     {"transform", " --translate 1,2,3"}};
  const std::set<std::string> of_other_files = {"neighbors", "render", "generate"};  // arrays, pictures; see below
  const auto has_output = [](const CLI::App* verb) { return verb->get_option_no_throw("-o") != nullptr; };
  CLI::App app;
  add_commands(app);
  std::size_t verbs = 0;
  for (const Format* format : formats_with_refused_names())
    for (const CLI::App* verb : app.get_subcommands(has_output)) {
      if (of_other_files.contains(verb->get_name())) continue;
      ++verbs;
      const auto other = others.find(verb->get_name());
      const std::string more = other == others.end() ? "" : other->second;
      for (const std::string name : {"out", "OUT"}) {
        std::string output = name + std::string(format->refused_ending);
        for (char& c : output)
          if (name == "OUT") c = static_cast<char>(std::toupper(c));
        refused(2, verb->get_name() + " in.ply -o " + output + more, "programs expect COPC under such a name");
        EXPECT_FALSE(exists(output)) << verb->get_name();
      }
    }
  EXPECT_GE(verbs, 8u);
}

TEST_F(OutputName, IsRefusedWhereverElseItIsGiven) {
  refused(2, "generate terrain a.copc.laz -n 9", "name the output a.laz, which gets LAZ");
  refused(2, "run in.ply a.copc.laz --dry-run --pipeline normals", "COPC");
  refused(2, "run in.ply -o out/ --output-format copc.laz --pipeline normals", "'copc.laz' is not one of");
  EXPECT_THROW(require_output_name("tiles/a.Copc.Laz"), UsageError);
  EXPECT_NO_THROW(require_output_name("copc.laz"));
  EXPECT_NO_THROW(require_output_name("a.copc.las"));
}

}  // namespace
}  // namespace pointsweep
