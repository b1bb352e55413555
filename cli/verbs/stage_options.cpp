// SPDX-License-Identifier: MIT
#include "cli/verbs/stage_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/text/help.h"

namespace pointsweep {
namespace {

/// Returns the word that stands for the value in the help.
std::string value_name(const OptionDeclaration& option) {
  switch (option.kind) {
    case OptionKind::whole:
      return "N";
    case OptionKind::number:
      return option.unit == "length" ? "LENGTH" : "NUMBER";
    case OptionKind::point:
      return "X,Y,Z";
    case OptionKind::names:
      return "NAME,...";
    case OptionKind::attribute:
      return "NAME";
    case OptionKind::condition:
      return "CONDITION";
    case OptionKind::numbers:
      return "NUMBER,...";
    case OptionKind::file:
      return "FILE";
    case OptionKind::attributes:
      return "NAME,...";
    case OptionKind::assignments:
      return "ASSIGNMENTS";
    case OptionKind::word:
      return "WORD";
    case OptionKind::choice:
      break;
  }
  return fmt::format("{}", fmt::join(option.choices, "|"));
}

/// "Number of neighbours, excluding the point (1 or more; default: 8)"
std::string help_of(const OptionDeclaration& option, const std::string& preset) {
  std::string meaning = option.meaning, range;
  if (!meaning.empty() && meaning[0] >= 'a' && meaning[0] <= 'z')
    meaning[0] = static_cast<char>(meaning[0] - 'a' + 'A');
  if (option.kind == OptionKind::whole || option.kind == OptionKind::number || option.kind == OptionKind::names)
    range = option.allowed();
  if (!preset.empty()) range += (range.empty() ? "default: " : "; default: ") + preset;
  return range.empty() ? meaning : fmt::format("{} ({})", meaning, range);
}

CLI::Option* add_option(CLI::App& verb, const std::string& flag, const OptionDeclaration& option,
                        const std::string& preset, std::vector<OptionText>& into) {
  return verb
      .add_option_function<std::string>(
          flag,
          [&into, flag, name = option.name](const std::string& value) {
            into.push_back({name, value, flag});
          },
          help_of(option, preset))
      ->type_name(value_name(option));
}

std::string flag_of(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return "--" + name;
}

}  // namespace

void add_stage_options(CLI::App& verb, const std::vector<OptionDeclaration>& options, std::vector<OptionText>& into) {
  for (const OptionDeclaration& option : options)
    add_option(verb, flag_of(option.name), option, text_of_value(option.preset), into);
}

void add_stage_option(CLI::App& verb, const std::string& flag, const OptionDeclaration& option,
                      std::vector<OptionText>& into) {
  add_option(verb, flag, option, text_of_value(option.preset), into);
}

void add_neighborhood_options(CLI::App& verb, const std::string& k, std::vector<OptionText>& into) {
  for (const OptionDeclaration& option : neighborhood_declaration().options) {
    const bool is_k = option.name == "k";
    add_option(verb, is_k ? "-k" : flag_of(option.name), option, is_k ? k : text_of_value(option.preset), into)
        ->group(kNeighborGroup);
  }
}

}  // namespace pointsweep
