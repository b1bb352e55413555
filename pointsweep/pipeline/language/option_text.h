// SPDX-License-Identifier: MIT
/// The parser of option values, shared by pipelines, JSON and flags.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/operators/declare/declaration.h"
#include "pointsweep/pipeline/language/parse.h"

namespace pointsweep {

/// The value, or nothing if `text` has not the form of the option's kind or the value is not allowed.
std::optional<OptionValue> parse_value(const OptionDeclaration& option, std::string_view text);

/// The values of a stage's options. Throws UsageError for an option that is not declared, given twice or missing, and
/// for a value that is not allowed.
OptionValues read_options(const std::vector<OptionDeclaration>& declared, const StageText& stage);

}  // namespace pointsweep
