// SPDX-License-Identifier: MIT
#include "cli/stage_options.h"

#include <fmt/format.h>

#include <algorithm>

namespace pointsweep {
namespace {

void add_option(CLI::App& verb, const std::string& flag, const OptionDeclaration& option, const std::string& preset,
                std::vector<OptionText>& into) {
  const std::string help =
      fmt::format("{}: {}{}", option.allowed(), option.meaning, preset.empty() ? "" : " (default: " + preset + ")");
  verb.add_option_function<std::string>(
          flag,
          [&into, flag, name = option.name](const std::string& value) {
            into.push_back({name, value, flag});
          },
          help)
      ->type_name("VALUE");
}

std::string flag_of(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return "--" + name;
}

}  // namespace

void add_stage_options(CLI::App& verb, const std::vector<OptionDeclaration>& options, std::vector<OptionText>& into) {
  for (const OptionDeclaration& option : options) add_option(verb, flag_of(option.name), option, option.preset, into);
}

void add_neighborhood_options(CLI::App& verb, const std::string& k, std::vector<OptionText>& into) {
  for (const OptionDeclaration& option : neighborhood_declaration().options) {
    const bool is_k = option.name == "k";
    add_option(verb, is_k ? "-k" : flag_of(option.name), option, is_k ? k : option.preset, into);
  }
}

StageText neighborhood_stage(const std::vector<OptionText>& given, const std::string& k, const std::string& verb) {
  StageText knn{neighborhood_declaration().name, given, verb};
  if (given.empty()) knn.options.push_back({"k", k, verb});
  return knn;
}

}  // namespace pointsweep
