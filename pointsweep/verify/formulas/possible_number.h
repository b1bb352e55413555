// SPDX-License-Identifier: MIT
/// Arithmetic, comparisons and functions of numbers that are known to lie in a range.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <string>

#include "pointsweep/verify/formulas/estimate.h"

namespace pointsweep::formulas {

/// The range of a name, or of a part of an expression. A single value is exact, and may be NaN.
struct PossibleNumber {
  Real low = 0, high = 0;
  bool is_whole = false;  ///< a 64-bit integer, or a whole number as written

  bool is_exact() const { return low == high || (low != low && high != high); }
};

inline PossibleNumber single_number(Real value) { return {value, value, false}; }

/// Rounds the range to float64, the type in which numbers are combined.
PossibleNumber as_double(const PossibleNumber& n);

/// `sign`: + - * or /.
PossibleNumber combined(char sign, PossibleNumber a, PossibleNumber b);

/// Returns the result of a comparison; nothing if the ranges do not decide. `sign`: == != < <= > or >=.
std::optional<bool> compared(const std::string& sign, const PossibleNumber& a, const PossibleNumber& b);

/// The value of a function of expressions. Functions other than exp, log and atan2 are exact for exact arguments.
PossibleNumber function_of(const std::string& name, std::span<const PossibleNumber> arguments);

}  // namespace pointsweep::formulas
