// SPDX-License-Identifier: MIT
/// The text of assignments of values to attributes, for all points or for the points for which a condition holds.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/operators/expressions/expression.h"

namespace pointsweep {

/// An assignment NAME = EXPRESSION [where CONDITION], e.g. intensity = intensity * 2 where classification == 2.
struct Assignment {
  std::string name;
  Expression value;
  std::optional<Expression> condition;

  std::string canonical() const;
};

/// Parses assignments separated by commas. Throws UsageError, beginning with `place`, for an invalid text.
std::vector<Assignment> assignments_of(std::string_view text, const std::string& place);

}  // namespace pointsweep
