// SPDX-License-Identifier: MIT
/// Attributes that the output does not hold and later stages do not see.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/chain.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration drop_declaration();

/// Returns the Drop of some attributes. Throws UsageError if there is none, or if a name is empty.
Drop drop_of(std::vector<std::string> attributes);

}  // namespace pointsweep
