// SPDX-License-Identifier: MIT
/// `pointsweep man [VERB]`: manual pages.
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "cli/console/console.h"
#include "cli/text/declared_options.h"
#include "cli/text/man_pages.h"
#include "cli/text/usage_errors.h"
#include "cli/verbs/commands.h"
#include "cli/verbs/common_options.h"
#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

struct ManCommand {
  CommonOptions common;
  std::string verb;
  std::filesystem::path folder;
};

void write_page(const std::filesystem::path& path, const std::string& page, bool overwrite) {
  if (!overwrite && std::filesystem::exists(path))
    fail("{}: exists; name another folder, or overwrite it with --force.", path.string());
  std::ofstream file(path, std::ios::binary);
  file << page;
  file.close();
  if (!file) fail("{}: cannot be written; check that the folder exists and has space.", path.string());
}

void write_pages(const CLI::App& app, const ManCommand& command) {
  write_page(command.folder / "pointsweep.1", man_page_of_tool(app), command.common.overwrite);
  for (const DeclaredVerb& verb : declared_verbs(app))
    write_page(command.folder / ("pointsweep-" + verb.name + ".1"), man_page_of_verb(app, verb.name),
               command.common.overwrite);
}

void print_page(const CLI::App& app, const std::string& verb) {
  const std::string page = verb.empty() ? man_page_of_tool(app) : man_page_of_verb(app, verb);
  if (page.empty()) fail_usage("{}\nRun 'pointsweep help' for the list of verbs.", unknown_verb_sentence(app, verb));
  print(page);
}

}  // namespace

void add_man_command(CLI::App& app) {
  CLI::App& verb = *app.add_subcommand("man", "Print a manual page, or write all of them");
  auto command = std::make_shared<ManCommand>();
  verb.add_option("VERB", command->verb, "Verb of the page (default: the page of the tool)")->type_name("");
  verb.add_option("--folder", command->folder, "Write the pages of the tool and of all verbs into this existing folder")
      ->type_name("DIR");
  add_force_option(verb, command->common);
  verb.footer(
      "Pages are roff with the macros of man(7).\n"
      "\nExample:\n"
      "  pointsweep man normals > pointsweep-normals.1");
  verb.callback([&app, command] {
    if (command->folder.empty()) return print_page(app, command->verb);
    if (!command->verb.empty()) fail_usage("man: --folder writes all pages; leave out '{}'.", command->verb);
    write_pages(app, *command);
  });
}

}  // namespace pointsweep
