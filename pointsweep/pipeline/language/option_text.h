// SPDX-License-Identifier: MIT
/// Values of options as text: the one parser of pipelines, JSON and flags, and the way back.
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

/// Numbers in their shortest form, points as "0,0,1.7"; parse_value() of it gives the value back. Empty: no value.
std::string text_of_value(const OptionValue& value);

/// The values of a stage's options. Throws UsageError for an option that is not declared, given twice or missing, and
/// for a value that is not allowed.
OptionValues read_options(const std::vector<OptionDeclaration>& declared, const StageText& stage);

}  // namespace pointsweep
