// SPDX-License-Identifier: MIT
#include "cli/text/declared_options.h"

#include <algorithm>
#include <sstream>

#include "cli/text/help.h"
#include "pointsweep/program/generate.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {
namespace {

std::vector<std::string> split_words(const std::string& text, char separator) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; std::getline(in, word, separator);) words.push_back(word);
  return words;
}

bool is_lower_case(const std::string& word) {
  return std::ranges::none_of(word, [](char c) { return c >= 'A' && c <= 'Z'; });
}

std::vector<std::string> names_of_operators() {
  std::vector<std::string> names = {neighborhood_declaration().name};
  for (const OperatorDeclaration& declaration : all_operators()) names.push_back(declaration.name);
  return names;
}

std::vector<std::string> names_of_shapes() {
  std::vector<std::string> names;
  for (const NamedShape& shape : shapes()) names.push_back(shape.name);
  return names;
}

/// Sets the kind of completions of an argument from the name that its verb gives it.
void set_offer_of_argument(DeclaredOption& argument, const CLI::App& app) {
  const std::string& name = argument.value;
  argument.offer = Offer::words;
  if (name == "VERB") argument.words = names_of_verbs(app);
  if (name == "NAME") argument.words = names_of_operators();
  if (name == "SHAPE") argument.words = names_of_shapes();
  if (name == "SHELL") argument.words = {"bash", "zsh", "fish"};
  if (argument.words.empty()) argument.offer = Offer::files;
}

/// Sets the kind of completions of an option from the name of its value: FILE, DIR, TEXT|FILE for a pipeline; a name of
/// several parts in lower case, like "input|sweep", lists the words.
void set_offer_of_option(DeclaredOption& option) {
  const std::vector<std::string> names = split_words(option.value, '|');
  const auto says = [&](const char* name) { return std::ranges::find(names, name) != names.end(); };
  if (says("FILE")) option.offer = says("TEXT") ? Offer::pipeline : Offer::files;
  if (says("DIR")) option.offer = Offer::folders;
  if (option.offer == Offer::pipeline) option.words = names_of_operators();
  if (names.size() < 2 || !std::ranges::all_of(names, is_lower_case)) return;
  option.offer = Offer::words;
  option.words = names;
}

DeclaredOption declared_option(const CLI::Option& option, const CLI::App& app) {
  DeclaredOption declared{.flags = {}, .value = option.get_type_name(), .meaning = option.get_description()};
  for (const std::string& name : option.get_snames()) declared.flags.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) declared.flags.push_back("--" + name);
  if (!declared.flags.empty()) {
    set_offer_of_option(declared);
    return declared;
  }
  declared.value = option.get_name(true);
  set_offer_of_argument(declared, app);
  if (declared.value == kInputsAndOutput) declared.value = "IN... OUT";
  return declared;
}

/// Returns the usage line of a verb as in its help: "pointsweep normals [OPTIONS] IN... OUT".
std::string usage_of(const CLI::App& verb, const CLI::App& app) {
  std::istringstream usage(HelpFormatter().make_usage(&verb, app.get_name() + " " + verb.get_name()));
  std::string text, word;
  while (usage >> word)
    if (word != "Usage:") text += (text.empty() ? "" : " ") + word;
  return text;
}

}  // namespace

std::vector<DeclaredVerb> declared_verbs(const CLI::App& app) {
  std::vector<DeclaredVerb> verbs;
  for (const CLI::App* verb : verbs_of(app)) {
    DeclaredVerb& declared = verbs.emplace_back();
    declared.name = verb->get_name();
    declared.meaning = verb->get_description();
    declared.usage = usage_of(*verb, app);
    declared.footer = verb->get_footer();
    for (const CLI::Option* option : verb->get_options()) {
      if (option->get_group().empty()) continue;
      DeclaredOption one = declared_option(*option, app);
      (one.flags.empty() ? declared.arguments : declared.options).push_back(std::move(one));
    }
  }
  return verbs;
}

std::vector<DeclaredOption> options_of_tool(const CLI::App& app) {
  std::vector<DeclaredOption> options;
  for (const CLI::Option* option : app.get_options()) options.push_back(declared_option(*option, app));
  return options;
}

std::string first_clause(const std::string& text) {
  std::size_t end = text.size();
  for (const char* mark : {" (", "; ", ". "}) end = std::min(end, text.find(mark));
  return text.substr(0, end);
}

}  // namespace pointsweep
