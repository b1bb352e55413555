// SPDX-License-Identifier: MIT
/// `pointsweep help [VERB]`: the same as `pointsweep [VERB] --help`.
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/console.h"
#include "cli/usage_errors.h"
#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

const CLI::App& verb_named(const CLI::App& app, const std::string& name) {
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    if (verb->get_name() == name) return *verb;
  fail_usage("{}\nRun 'pointsweep help' for the list of verbs.", unknown_verb_sentence(app, name));
}

}  // namespace

void add_help_command(CLI::App& app) {
  CLI::App& verb = *app.add_subcommand("help", "Show this help, or the help of a verb");
  auto name = std::make_shared<std::string>();
  verb.add_option("VERB", *name, "Verb to explain (default: list all verbs)")->type_name("");
  verb.footer("Example:\n  pointsweep help normals");
  verb.callback([&app, name] {
    const CLI::App& shown = name->empty() ? app : verb_named(app, *name);
    const std::string title = name->empty() ? app.get_name() : app.get_name() + " " + *name;
    print(app.get_formatter()->make_help(&shown, title, CLI::AppFormatMode::Normal));
  });
}

}  // namespace pointsweep
