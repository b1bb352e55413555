// SPDX-License-Identifier: MIT
/// The operators by name. A new operator is a pair of files with its declaration, and a line in registry.cpp.
#pragma once

#include <string_view>
#include <vector>

#include "pointsweep/operators/declare/declaration.h"
#include "pointsweep/operators/declare/neighborhood_declaration.h"
#include "pointsweep/pipeline/language/option_text.h"

namespace pointsweep {

/// The operators of pipelines, in the order of their presentation.
const std::vector<OperatorDeclaration>& all_operators();

/// Returns the declaration of an operator; null if no operator has this name.
const OperatorDeclaration* declaration_of(std::string_view name);

/// Returns advice for a word of other programs, e.g. "reproject" or "merge"; empty for all other words.
std::string_view advice_for(std::string_view word);

/// Returns the operator of `stage`. Throws UsageError with the most similar known names.
const OperatorDeclaration& find_operator(const StageText& stage);

}  // namespace pointsweep
