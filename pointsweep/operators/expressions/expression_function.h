// SPDX-License-Identifier: MIT
/// The functions that expressions call by name.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace pointsweep {

struct ExpressionFunction {
  std::string_view name;
  std::size_t least, most;  ///< least and largest number of arguments
  double (*value)(std::span<const double> arguments);
};

/// Returns the function with a name; null if no function has it.
const ExpressionFunction* expression_function(std::string_view name);

/// Returns the names of all functions, separated by blanks.
std::string names_of_functions();

}  // namespace pointsweep
