// SPDX-License-Identifier: MIT
/// `pointsweep help [VERB]`: the same as `pointsweep [VERB] --help`; of an operator its listing.
#include <memory>
#include <string>

#include "cli/console/console.h"
#include "cli/text/operator_listing.h"
#include "cli/text/usage_errors.h"
#include "cli/verbs/commands.h"
#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

std::string help_of(const CLI::App& app, const std::string& name) {
  const CLI::App* const shown = name.empty() ? &app : find_verb(app, name);
  const std::string title = app.get_name() + (name.empty() ? "" : " " + name);
  if (shown != nullptr) return app.get_formatter()->make_help(shown, title, CLI::AppFormatMode::Normal);
  const std::string text = help_of_operator(name);
  if (text.empty()) fail_usage("{}\nRun 'pointsweep help' for the list of verbs.", unknown_verb_sentence(app, name));
  return text;
}

}  // namespace

void add_help_command(CLI::App& app) {
  CLI::App& verb = *app.add_subcommand("help", "Show this help, or the help of a verb or an operator");
  auto name = std::make_shared<std::string>();
  verb.add_option("VERB", *name, "Verb or operator to explain (default: list all verbs)")->type_name("");
  verb.footer("Example:\n  pointsweep help normals");
  verb.callback([&app, name] { print(help_of(app, *name)); });
}

}  // namespace pointsweep
