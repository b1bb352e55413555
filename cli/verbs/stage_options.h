// SPDX-License-Identifier: MIT
/// Options of stages as flags of a verb: names, ranges, meanings and defaults come from their declarations.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "pointsweep/pipeline/language/registry.h"

namespace pointsweep {

/// "--f VALUE" for the option f, "--k-from" for k_from. What is given is appended to `into`, which outlives the
/// parsing.
void add_stage_options(CLI::App& verb, const std::vector<OptionDeclaration>& options, std::vector<OptionText>& into);

/// Adds one option under the given flag.
void add_stage_option(CLI::App& verb, const std::string& flag, const OptionDeclaration& option,
                      std::vector<OptionText>& into);

/// -k, --radius and what else says which points are neighbours; `k` is the verb's default; empty: the pipeline's.
void add_neighborhood_options(CLI::App& verb, const std::string& k, std::vector<OptionText>& into);

}  // namespace pointsweep
