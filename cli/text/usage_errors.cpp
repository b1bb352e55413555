// SPDX-License-Identifier: MIT
/// Errors of the command line as sentences, with the verb or option that was probably meant.

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "cli/text/help.h"
#include "cli/text/operator_listing.h"
#include "pointsweep/program/nearest_names.h"
#include "pointsweep/program/pipeline.h"

namespace pointsweep {
namespace {

/// A verb of other programs, and the command of pointsweep that does the same.
struct OtherVerb {
  std::string_view word, command;
};

constexpr OtherVerb kOtherVerbs[] = {{"merge", "convert IN... OUT"},
                                     {"copy", "convert IN... OUT"},
                                     {"translate", "convert IN... OUT"},
                                     {"compress", "convert IN... OUT.laz"},
                                     {"clip", "run IN... OUT --pipeline 'crop([0,0,100,100])'"},
                                     {"filter", "run IN... OUT --pipeline 'where(classification == 2)'"},
                                     {"pipeline", "run IN... OUT --pipeline 'knn(k=8) | normals'"},
                                     {"subsample", "thin IN... OUT --voxel 0.5"},
                                     {"downsample", "thin IN... OUT --voxel 0.5"},
                                     {"outliers", "denoise IN... OUT"},
                                     {"smooth", "fair IN... OUT"},
                                     {"view", "render IN... OUT.png"},
                                     {"stats", "info IN..."}};

/// Returns "--quiet", "-q", ...: the options shown in the help.
std::vector<std::string> options_of(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const CLI::Option* option : verb.get_options()) {
    if (option->get_group().empty()) continue;
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

/// Returns a sentence about an unknown option, with the option that was probably meant. Leading dashes do not count.
std::string unknown_option_sentence(const CLI::App& verb, const std::string& word) {
  const std::string given = word.substr(0, word.find('='));
  const std::string bare = given.substr(std::min(given.find_first_not_of('-'), given.size()));
  std::vector<std::string> bare_names;
  for (const std::string& name : options_of(verb))
    if (name.starts_with("--")) bare_names.push_back(name.substr(2));
  const auto meant = probable_name(bare, bare_names);
  const std::string hint = meant ? fmt::format(" Did you mean '--{}'?", *meant) : "";
  return fmt::format("{}: '{}' is not an option of this verb.{}", verb.get_name(), given, hint);
}

/// Returns a sentence about words, before or after the verb, that no option and no list of files has taken.
std::string extras_sentence(const CLI::App& app, const CLI::App* verb) {
  const std::vector<std::string> before = app.remaining();
  if (!before.empty() && before.front().starts_with('-'))
    return fmt::format("'{}' comes before the verb; write the verb first, then its options.", before.front());
  if (!before.empty() || verb == nullptr) return unknown_verb_sentence(app, before.empty() ? "" : before.front());
  const std::vector<std::string> unknown = verb->remaining();
  for (const std::string& word : unknown)
    if (word.starts_with('-') && word != "--") return unknown_option_sentence(*verb, word);
  return fmt::format("{}: '{}' is one argument too many.", verb->get_name(), unknown.front());
}

/// Returns a sentence about a value that the parser has refused. Replaces messages of the parser that count values,
/// because each option of the tool has one value.
std::string parser_sentence(const CLI::ParseError& error) {
  std::string text = error.what();
  if (text.starts_with(kInputsAndOutput)) text.replace(0, std::string_view(kInputsAndOutput).size(), "IN... OUT");
  if (error.get_name() != "ArgumentMismatch") return text + ".";
  const std::string option = text.substr(0, text.find(':'));
  return text.find("At Most") == text.npos ? option + " needs a value." : option + " is given more than once.";
}

}  // namespace

std::vector<const CLI::App*> verbs_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<std::string> names_of_verbs(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* verb : verbs_of(app)) names.push_back(verb->get_name());
  return names;
}

const CLI::App* find_verb(const CLI::App& app, const std::string& name) {
  for (const CLI::App* verb : verbs_of(app))
    if (verb->get_name() == name) return verb;
  return nullptr;
}

std::string unknown_verb_sentence(const CLI::App& app, const std::string& word) {
  if (const std::string command = command_of_operator(word); !command.empty())
    return fmt::format("'{}' is an operator, not a verb: {}", word, command);
  if (const auto* other = std::ranges::find(kOtherVerbs, word, &OtherVerb::word); other != std::end(kOtherVerbs))
    return fmt::format("'{}' is not a verb; 'pointsweep {}' does it.", word, other->command);
  if (const std::string_view advice = advice_for(word); !advice.empty())
    return fmt::format("'{}' is not a verb; in the pipeline of 'pointsweep run', {}.", word, advice);
  const auto meant = probable_name(word, names_of_verbs(app));
  return fmt::format("'{}' is not a verb.{}", word, meant ? fmt::format(" Did you mean '{}'?", *meant) : "");
}

std::string usage_sentence(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> parsed = app.get_subcommands();
  const CLI::App* verb = parsed.empty() ? nullptr : parsed.front();
  const bool extras = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr || !app.remaining().empty();
  const std::string place = verb == nullptr ? "" : verb->get_name() + ": ";
  const std::string sentence = extras ? extras_sentence(app, verb) : place + parser_sentence(error);
  return fmt::format("{}\nRun 'pointsweep help{}' for help.", sentence, verb == nullptr ? "" : " " + verb->get_name());
}

}  // namespace pointsweep
