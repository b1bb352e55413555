// SPDX-License-Identifier: MIT
/// Arithmetic, comparisons and functions of numbers that are known to lie in a range.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <string>

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

/// Rounds the range to float64, the type in which numbers are combined.
PossibleNumber as_double(const PossibleNumber& n);

/// Returns the range of `a` combined with `b`. `sign`: + - * or /.
PossibleNumber combined(char sign, PossibleNumber a, PossibleNumber b);

/// Returns the result of a comparison; nothing if the ranges do not decide. `sign`: == != < <= > or >=.
std::optional<bool> compared(const std::string& sign, const PossibleNumber& a, const PossibleNumber& b);

/// Returns the range of a function of expressions. Functions other than exp, log and atan2 are exact for exact
/// arguments.
PossibleNumber function_of(const std::string& name, std::span<const PossibleNumber> arguments);

}  // namespace pointsweep::formulas
