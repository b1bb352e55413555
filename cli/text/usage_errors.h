// SPDX-License-Identifier: MIT
/// Errors of the command line as sentences, with the verb or option that was probably meant.
#pragma once

#include <CLI/App.hpp>
#include <string>

namespace pointsweep {

/// Returns a sentence on what is wrong with the command line that `app` has just refused, and what to do.
std::string usage_sentence(const CLI::App& app, const CLI::ParseError& error);

/// Null where no verb has that name.
const CLI::App* find_verb(const CLI::App& app, const std::string& name);

/// "'norml' is not a verb. Did you mean 'normals'?"
std::string unknown_verb_sentence(const CLI::App& app, const std::string& word);

}  // namespace pointsweep
