// SPDX-License-Identifier: MIT
#include "cli/verbs/commands.h"

#include <algorithm>
#include <iterator>
#include <string>

#include "cli/text/help.h"

namespace pointsweep {
namespace {

/// Refuses options with empty values: an empty file name would mean the current folder, and other options need a value.
void refuse_empty_values(CLI::App& verb) {
  const CLI::Validator not_empty(
      [](std::string& value) {
        return std::string(value.empty() ? "the value is empty; give one, or leave the option out" : "");
      },
      "");
  for (CLI::Option* option : verb.get_options())
    if (option->get_items_expected_max() > 0) option->check(not_empty);
}

/// Verbs that print the options of other verbs.
constexpr const char* kVerbsOfVerbs[] = {"help", "completion", "man"};

std::vector<Verb> all_verbs() {
  std::vector<Verb> verbs = {kConvertVerb};
  std::ranges::copy(short_form_verbs(), std::back_inserter(verbs));
  for (const Verb& verb :
       {kThinVerb, kTransformVerb, kTileVerb, kSplitVerb, kGroundVerb, kNeighborsVerb, kSortVerb, kRunVerb,
        kOperatorsVerb, kVerifyVerb, kInfoVerb, kGenerateVerb, kRenderVerb, kCompletionVerb, kManVerb, kHelpVerb})
    verbs.push_back(verb);
  return verbs;
}

}  // namespace

void add_verbs(CLI::App& app, std::string_view asked) {
  const std::vector<Verb> verbs = all_verbs();
  const auto is_asked = [&](const Verb& verb) { return verb.name == asked; };
  const bool declare_all = std::ranges::none_of(verbs, is_asked) || std::ranges::count(kVerbsOfVerbs, asked) > 0;
  for (const Verb& verb : verbs) {
    CLI::App& added = *app.add_subcommand(verb.name, verb.meaning);
    added.group("Verbs");
    added.get_help_ptr()->group(kOtherGroup);
    if (!declare_all && !is_asked(verb)) continue;
    verb.declare(added);
    refuse_empty_values(added);
  }
}

}  // namespace pointsweep
