// SPDX-License-Identifier: MIT
/// Verbs with their options and arguments as the command line declares them: the source of completions and man pages.
#pragma once

#include <CLI/App.hpp>
#include <cstdint>
#include <string>
#include <vector>

namespace pointsweep {

/// The kind of completions that a shell can offer for a value.
enum class Offer : std::uint8_t {
  nothing,  ///< numbers and names, of which only the user knows
  words,    ///< DeclaredOption::words
  files,
  folders,
  pipeline,  ///< names of operators, or a file
};

struct DeclaredOption {
  std::vector<std::string> flags;  ///< "-q", "--quiet"; empty for an argument
  std::string value;               ///< "N", "input|sweep", of an argument "IN... OUT"; empty: it has no value
  std::string meaning;
  Offer offer = Offer::nothing;
  std::vector<std::string> words = {};
};

struct DeclaredVerb {
  std::string name, meaning;
  std::string usage;  ///< "pointsweep normals [OPTIONS] IN... OUT"
  std::vector<DeclaredOption> arguments, options;
  std::string footer;
};

/// Returns all verbs, in the order of the help, without hidden options.
std::vector<DeclaredVerb> declared_verbs(const CLI::App& app);
/// Returns the options of the tool itself, outside of the verbs.
std::vector<DeclaredOption> options_of_tool(const CLI::App& app);

/// `text` up to the first parenthesis, semicolon or end of a sentence.
std::string first_clause(const std::string& text);

}  // namespace pointsweep
