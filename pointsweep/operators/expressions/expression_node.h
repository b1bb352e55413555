// SPDX-License-Identifier: MIT
/// The nodes of an expression, between its parser and its evaluation, and the functions that they call by name.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/operators/expressions/expression.h"

namespace pointsweep {

/// A function that expressions call by name.
struct ExpressionFunction {
  std::string_view name;
  std::size_t least, most;  ///< least and largest number of arguments
  double (*value)(std::span<const double> arguments);
};

/// Returns the function with a name; null if no function has it.
const ExpressionFunction* expression_function(std::string_view name);

/// Returns the names of all functions, separated by blanks.
std::string names_of_functions();

/// The operation of a node. Operations from `equal` on give a truth value, the others a number.
enum class Operation : std::uint8_t {
  number,
  name,
  negate,
  add,
  subtract,
  multiply,
  divide,
  function,
  equal,
  unequal,
  less,
  less_equal,
  greater,
  greater_equal,
  among,    ///< true if the first part is equal to one of the others
  between,  ///< true if the first part is between the second and the third, inclusive
  no,
  both,
  either
};

struct Expression::Node {
  Operation operation = Operation::number;
  double number = 0;
  std::optional<WholeNumber> whole = {};  ///< exact value of a literal that is a whole number
  std::size_t name = 0;                   ///< index in Expression::names()
  const ExpressionFunction* function = nullptr;
  std::vector<Node> parts = {};

  bool is_condition() const { return operation >= Operation::equal; }
};

}  // namespace pointsweep
