// SPDX-License-Identifier: MIT
/// The verbs that the tool declares.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/verbs/commands.h"

namespace pointsweep {

inline std::vector<std::string> every_verb() {
  CLI::App app;
  add_verbs(app);
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(verb->get_name());
  return names;
}

}  // namespace pointsweep
