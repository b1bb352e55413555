// SPDX-License-Identifier: MIT
/// The verbs that print texts:
/// - `pointsweep help [VERB]`: the help of a verb, or the listing of an operator;
/// - `pointsweep completion SHELL`: a script for the shell;
/// - `pointsweep man [VERB]`: manual pages;
/// - `pointsweep operators [NAME...]`: the operators of pipelines, from their declarations.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/console/console.h"
#include "cli/text/declared_options.h"
#include "cli/text/help.h"
#include "cli/text/operator_listing.h"
#include "cli/verbs/commands.h"
#include "cli/verbs/common_options.h"
#include "pointsweep/program/whole_file.h"

namespace pointsweep {
namespace {

std::string help_of(const CLI::App& app, const std::string& name) {
  const CLI::App* const shown = name.empty() ? &app : find_verb(app, name);
  const std::string title = app.get_name() + (name.empty() ? "" : " " + name);
  if (shown != nullptr) return app.get_formatter()->make_help(shown, title, CLI::AppFormatMode::Normal);
  const std::string text = help_of_operator(name);
  if (text.empty()) refuse("{}\nRun 'pointsweep help' for the list of verbs.", unknown_verb_sentence(app, name));
  return text;
}

std::string completion_for(const CLI::App& app, const std::string& shell) {
  if (shell == "bash") return bash_completion(app);
  if (shell == "zsh") return zsh_completion(app);
  if (shell == "fish") return fish_completion(app);
  refuse("completion: '{}' is not bash, zsh or fish.", shell);
}

struct ManCommand {
  CommonOptions common;
  std::string verb;
  std::filesystem::path folder;
};

void write_pages(const CLI::App& app, const ManCommand& command) {
  WholeFile(command.folder / "pointsweep.1", command.common.overwrite).complete(man_page_of_tool(app));
  for (const DeclaredVerb& verb : declared_verbs(app))
    WholeFile(command.folder / ("pointsweep-" + verb.name + ".1"), command.common.overwrite)
        .complete(man_page_of_verb(app, verb.name));
}

void print_page(const CLI::App& app, const std::string& verb) {
  const std::string page = verb.empty() ? man_page_of_tool(app) : man_page_of_verb(app, verb);
  if (page.empty()) refuse("{}\nRun 'pointsweep help' for the list of verbs.", unknown_verb_sentence(app, verb));
  print(page);
}

struct OperatorsCommand {
  std::vector<std::string> names;
  bool json = false, markdown = false, attributes = false;
};

void list_operators(const OperatorsCommand& command) {
  if (command.attributes) return print(attributes_markdown());
  const std::vector<ListedOperator> operators = listed_operators(command.names);
  print(command.json ? to_json(operators) : command.markdown ? to_markdown(operators) : to_text(operators));
}

}  // namespace

void declare_help_verb(CLI::App& verb) {
  const CLI::App& app = *verb.get_parent();
  auto name = std::make_shared<std::string>();
  verb.add_option("VERB", *name, "Verb or operator to explain (default: list all verbs)")->type_name("");
  verb.footer("Example:\n  pointsweep help normals");
  verb.callback([&app, name] { print(help_of(app, *name)); });
}

void declare_completion_verb(CLI::App& verb) {
  const CLI::App& app = *verb.get_parent();
  auto shell = std::make_shared<std::string>();
  verb.add_option("SHELL", *shell, "bash, zsh or fish")->required()->type_name("");
  verb.footer(
      "An installed pointsweep has these scripts where the shells look for them. Otherwise source the script, e.g. in\n"
      "~/.bashrc:\n"
      "  source <(pointsweep completion bash)\n"
      "\nExample:\n"
      "  pointsweep completion bash > pointsweep.bash");
  verb.callback([&app, shell] { print(completion_for(app, *shell)); });
}

void declare_man_verb(CLI::App& verb) {
  const CLI::App& app = *verb.get_parent();
  auto command = std::make_shared<ManCommand>();
  verb.add_option("VERB", command->verb, "Verb of the page (default: the page of the tool)")->type_name("");
  verb.add_option("--folder", command->folder, "Write the pages of the tool and of all verbs into this existing folder")
      ->type_name("DIR");
  add_run_option(verb, command->common, "overwrite");
  verb.footer(
      "Pages are roff with the macros of man(7).\n"
      "\nExample:\n"
      "  pointsweep man normals > pointsweep-normals.1");
  verb.callback([&app, command] {
    if (command->folder.empty()) return print_page(app, command->verb);
    if (!command->verb.empty()) refuse("man: --folder writes all pages; leave out '{}'.", command->verb);
    write_pages(app, *command);
  });
}

void declare_operators_verb(CLI::App& verb) {
  auto command = std::make_shared<OperatorsCommand>();
  verb.add_option("NAME", command->names, "Operators to list (default: all)")->type_name("");
  CLI::Option* json = verb.add_flag("--json", command->json, "Print a JSON array");
  CLI::Option* markdown = verb.add_flag("--markdown", command->markdown, "Print docs/operators.md");
  verb.add_flag("--attributes", command->attributes, "Print the table of docs/attributes.md")
      ->excludes(json)
      ->excludes(markdown);
  json->excludes(markdown);
  verb.footer(
      "'needs' and 'makes' are those of an operator without options. The examples are stages for 'pointsweep run'.\n"
      "\nExample:\n"
      "  pointsweep operators knn normals");
  verb.callback([command] { list_operators(*command); });
}

}  // namespace pointsweep
