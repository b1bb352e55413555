// SPDX-License-Identifier: MIT
/// Attributes that the output does not hold and later stages do not see.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/chain.h"

namespace pointsweep {

struct OperatorDeclaration;

OperatorDeclaration drop_declaration();

/// Throws UsageError unless it names an attribute.
Drop drop_of(std::vector<std::string> attributes);

}  // namespace pointsweep
