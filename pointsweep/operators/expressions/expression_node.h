// SPDX-License-Identifier: MIT
/// The nodes of an expression, between its parser and its evaluation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pointsweep/operators/expressions/expression.h"

namespace pointsweep {

/// The operation of a node. Operations from `equal` on give a truth value, the others a number.
enum class Operation : std::uint8_t {
  number,
  name,
  negate,
  add,
  subtract,
  multiply,
  divide,
  equal,
  unequal,
  less,
  less_equal,
  greater,
  greater_equal,
  no,
  both,
  either
};

struct Expression::Node {
  Operation operation = Operation::number;
  double number = 0;
  std::optional<std::int64_t> whole = {};   ///< value of a whole number below 2^63
  std::optional<std::uint64_t> large = {};  ///< value of a whole number from 2^63 on
  std::size_t name = 0;                     ///< index in names()
  std::vector<Node> parts = {};

  bool is_condition() const { return operation >= Operation::equal; }
};

}  // namespace pointsweep
