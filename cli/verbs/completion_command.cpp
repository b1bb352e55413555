// SPDX-License-Identifier: MIT
/// `pointsweep completion SHELL`: a script for the shell.
#include <memory>
#include <string>

#include "cli/console/console.h"
#include "cli/text/completion.h"
#include "cli/verbs/commands.h"
#include "pointsweep/fail.h"

namespace pointsweep {
namespace {

std::string completion_for(const CLI::App& app, const std::string& shell) {
  if (shell == "bash") return bash_completion(app);
  if (shell == "zsh") return zsh_completion(app);
  if (shell == "fish") return fish_completion(app);
  fail_usage("completion: '{}' is not bash, zsh or fish.", shell);
}

}  // namespace

void add_completion_command(CLI::App& app) {
  CLI::App& verb = *app.add_subcommand("completion", "Print a script that completes commands in a shell");
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

}  // namespace pointsweep
