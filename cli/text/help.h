// SPDX-License-Identifier: MIT
/// Layout of help: lines as wide as the terminal, flags in groups, plain names, and IN... OUT for a verb whose last
/// file is its output; errors of the command line as sentences.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Formatter.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "cli/console/console.h"

namespace pointsweep {

inline constexpr const char* kInputsAndOutput = "FILES";  ///< name of the arguments IN... OUT in the parser

/// Groups of flags, in the order of the help. The first group holds flags that only one verb or a few have.
inline constexpr const char* kOwnGroup = "Options";
inline constexpr const char* kNeighborGroup = "Neighbours";
inline constexpr const char* kOutputGroup = "Output";
inline constexpr const char* kMachineGroup = "Memory and machine";
inline constexpr const char* kOtherGroup = "Other";
inline constexpr const char* kGroups[] = {kOwnGroup, kNeighborGroup, kOutputGroup, kMachineGroup, kOtherGroup};

/// Returns `text`, broken at blanks into lines of at most `columns` characters. The first line begins at column
/// `indent` of a line that the caller has begun; the others get `indent` blanks. A word longer than a line is not
/// broken.
std::string wrapped(std::string_view text, std::size_t indent, std::size_t columns = text_columns());

/// Returns the text with its first letter, if that is one of a to z, in upper case.
std::string capitalized(std::string text);

/// Lays out help. In footers, lines that begin with a blank (examples, tables) are kept; the other lines form
/// paragraphs, which are wrapped.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter();
  std::string make_description(const CLI::App* app) const override;
  std::string make_option(const CLI::Option* option, bool positional) const override;
  std::string make_option_name(const CLI::Option* option, bool positional) const override;
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_usage(const CLI::Option* option) const override;
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
  std::string make_subcommand(const CLI::App* verb) const override;
  std::string make_footer(const CLI::App* app) const override;

 private:
  std::string options_in_groups(const CLI::App* app) const;
  std::string row(const std::string& left, const std::string& right) const;
};

/// Returns a sentence about the error in the command line that `app` has just refused, with the remedy.
std::string usage_sentence(const CLI::App& app, const CLI::ParseError& error);

/// Returns the verbs of the tool, in the order of the help.
std::vector<const CLI::App*> verbs_of(const CLI::App& app);
std::vector<std::string> names_of_verbs(const CLI::App& app);

/// Returns the verb; null if no verb has that name.
const CLI::App* find_verb(const CLI::App& app, const std::string& name);

/// Returns a sentence like "'norml' is not a verb. Did you mean 'normals'?".
std::string unknown_verb_sentence(const CLI::App& app, const std::string& word);

}  // namespace pointsweep
