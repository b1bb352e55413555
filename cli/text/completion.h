// SPDX-License-Identifier: MIT
/// Scripts that complete verbs, options, values, operators and files of the tool in a shell.
#pragma once

#include <CLI/App.hpp>
#include <string>

namespace pointsweep {

/// Needs no bash-completion package; bash 4 or later.
std::string bash_completion(const CLI::App& app);
/// A zsh script to be sourced after compinit, or kept as `_pointsweep` in a folder of $fpath.
std::string zsh_completion(const CLI::App& app);
/// fish 3 or later.
std::string fish_completion(const CLI::App& app);

}  // namespace pointsweep
