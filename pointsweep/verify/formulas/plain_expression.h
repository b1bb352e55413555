// SPDX-License-Identifier: MIT
/// The expressions of set() and where(): numbers and conditions, parsed and evaluated by independent code, with
/// arithmetic, comparisons and functions of numbers that are known to lie in a range.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// The range in which the value of a name, or of a part of an expression, lies. A range of a single value, which may be
/// NaN, is exact.
struct PossibleNumber {
  Real low = 0, high = 0;
  bool is_whole = false;  ///< true for a 64-bit integer and for a whole number in the text of an expression

  bool is_exact() const { return low == high || (low != low && high != high); }
};

inline PossibleNumber single_number(Real value) { return {value, value, false}; }

/// Returns the range with both ends rounded to float64, the type in which the operator combines numbers.
PossibleNumber as_double(const PossibleNumber& n);

/// Returns the range of `a` combined with `b`. `sign`: + - * or /.
PossibleNumber combined(char sign, PossibleNumber a, PossibleNumber b);

/// Returns the result of a comparison; nothing if the ranges do not decide. `sign`: == != < <= > or >=.
std::optional<bool> compared(const std::string& sign, const PossibleNumber& a, const PossibleNumber& b);

/// Returns the range of a function of expressions. Functions other than exp, log and atan2 are exact for exact
/// arguments.
PossibleNumber function_of(const std::string& name, std::span<const PossibleNumber> arguments);

/// An expression whose syntax the operator has already checked.
class PlainExpression {
 public:
  explicit PlainExpression(std::string_view text);
  /// Returns the names in the order in which they first occur in the text, each once.
  const std::vector<std::string>& names() const { return names_; }
  /// Returns the range of the expression. `values`: the range of the value of each of names().
  PossibleNumber number(std::span<const PossibleNumber> values) const;
  /// Returns whether the condition holds; nothing if the ranges do not decide.
  std::optional<bool> holds(std::span<const PossibleNumber> values) const;

 private:
  struct Token {
    std::string sign;       ///< an operator or a function; "-1" for the unary minus; empty for a number or a name
    std::size_t parts = 0;  ///< number of operands that the operator or function takes
    PossibleNumber value = {};
    bool is_name = false;
    std::size_t name = 0;
  };
  struct Part {
    PossibleNumber number;
    bool is_literal = false;
    std::optional<bool> truth = {};
  };
  Part evaluate(std::span<const PossibleNumber> values) const;
  static Part result_of(const Token& token, std::span<const Part> parts);
  static std::optional<bool> truth_of(const std::string& sign, const Part& left, const Part& right);
  void read(std::string_view text);

  std::vector<std::string> names_;
  std::vector<Token> postfix_;
};

/// The ways in which an attribute stores a number: as the nearest whole number with halves to even, as float32, or as
/// float64.
enum class Storage : unsigned char { whole, single, real };
Estimate stored_number(const PossibleNumber& number, Storage storage);

}  // namespace pointsweep::formulas
