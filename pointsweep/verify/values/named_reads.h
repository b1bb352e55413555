// SPDX-License-Identifier: MIT
/// The values of a point that the names of an expression stand for, as far as they are known.
#pragma once

#include <vector>

#include "pointsweep/verify/formulas/assignment.h"
#include "pointsweep/verify/values/stage_formula.h"

namespace pointsweep {

struct NamedRead {
  ReadValue value;
  bool is_whole = false;  ///< it is a 64-bit integer
};

/// What each name of the expression stands for; `reads`: of the stage that evaluates it.
std::vector<NamedRead> reads_of(const formulas::PlainExpression& expression, const std::vector<Attribute>& reads);

/// The ranges of the values of a point.
std::vector<formulas::PossibleNumber> values_of(const std::vector<NamedRead>& names, const FormulaInput& in);

}  // namespace pointsweep
