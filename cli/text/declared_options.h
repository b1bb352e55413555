// SPDX-License-Identifier: MIT
/// Lists of the verbs with their options and arguments, as the command line declares them; completion scripts for
/// shells and manual pages in roff, which are written from these lists.
#pragma once

#include <CLI/App.hpp>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pointsweep {

/// The kind of completions that a shell can offer for a value.
enum class Offer : std::uint8_t {
  nothing,  ///< no proposals: numbers and names that only the user knows
  words,    ///< the words in DeclaredOption::words
  files,
  folders,
  pipeline,  ///< names of operators, or a file
};

struct DeclaredOption {
  std::vector<std::string> flags;  ///< names such as "-q" and "--quiet"; empty for an argument
  std::string value;               ///< name of the value, e.g. "N", "input|sweep" or "IN... OUT"; empty without a value
  std::string meaning;
  Offer offer = Offer::nothing;
  std::vector<std::string> words = {};
};

struct DeclaredVerb {
  std::string name, meaning;
  std::string usage;  ///< usage line, e.g. "pointsweep normals [OPTIONS] IN... OUT"
  std::vector<DeclaredOption> arguments, options;
  std::string footer;
};

/// Returns all verbs, in the order of the help, without hidden options.
std::vector<DeclaredVerb> declared_verbs(const CLI::App& app);
/// Returns the options of the tool itself, outside of the verbs.
std::vector<DeclaredOption> options_of_tool(const CLI::App& app);

/// Returns `text` up to the first parenthesis, semicolon or end of a sentence.
std::string first_clause(const std::string& text);

/// Returns a script for bash 4 or later, which needs no bash-completion package.
std::string bash_completion(const CLI::App& app);
/// Returns a zsh script to be sourced after compinit, or stored as `_pointsweep` in a folder of $fpath.
std::string zsh_completion(const CLI::App& app);
/// Returns a script for fish 3 or later.
std::string fish_completion(const CLI::App& app);

/// Returns pointsweep(1): the purpose of the tool, its verbs, its exit status.
std::string man_page_of_tool(const CLI::App& app);
/// Returns the manual page pointsweep-VERB(1); empty if the tool has no such verb.
std::string man_page_of_verb(const CLI::App& app, std::string_view verb);

}  // namespace pointsweep
