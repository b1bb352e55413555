// SPDX-License-Identifier: MIT
/// The names in an expression: the attribute for which each name stands, and the range in which its value at a point is
/// known to lie.
#pragma once

#include <vector>

#include "pointsweep/verify/formulas/assignment.h"
#include "pointsweep/verify/values/stage_formula.h"

namespace pointsweep {

struct NamedRead {
  ReadValue value;
  bool is_whole = false;  ///< true if the value is a 64-bit integer
};

/// Returns the read value of each name of the expression, in the order of names(). `reads` are the attributes that the
/// stage reads.
std::vector<NamedRead> reads_of(const formulas::PlainExpression& expression, const std::vector<Attribute>& reads);

/// Returns the range of the value of each name at a point.
std::vector<formulas::PossibleNumber> values_of(const std::vector<NamedRead>& names, const FormulaInput& in);

}  // namespace pointsweep
