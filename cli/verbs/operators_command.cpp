// SPDX-License-Identifier: MIT
/// `pointsweep operators [NAME...]`: what a pipeline can be made of, as the declarations say.
#include <memory>
#include <string>
#include <vector>

#include "cli/console/console.h"
#include "cli/text/operator_listing.h"
#include "cli/verbs/commands.h"

namespace pointsweep {
namespace {

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

void add_operators_command(CLI::App& app) {
  CLI::App& verb = *app.add_subcommand("operators", "List the operators, their options, inputs and outputs");
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
