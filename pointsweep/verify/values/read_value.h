// SPDX-License-Identifier: MIT
/// The values that expressions name, among what their stage reads.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/verify/values/stage_formula.h"

namespace pointsweep {

/// A component of an attribute that a stage reads, by number in its contract, or of the position.
struct ReadValue {
  int attribute = -1;  ///< negative: the position
  std::size_t component = 0;
};

/// Finds what `name` means, in any spelling. `reads`: of a stage that reads it.
ReadValue read_of(const std::string& name, const std::vector<Attribute>& reads);

formulas::Estimate estimate_of(const ReadValue& value, const FormulaInput& in);
/// Returns the component of an estimate. An estimate has three at most; a wider attribute has an estimate for each.
formulas::Real component_of(const formulas::Estimate& estimate, const ReadValue& value);

}  // namespace pointsweep
