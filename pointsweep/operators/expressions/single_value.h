// SPDX-License-Identifier: MIT
/// Attributes that an operator reads by name, wherever they come from.
#pragma once

#include <optional>
#include <span>

#include "pointsweep/operator.h"

namespace pointsweep {

/// Returns the attribute of one value that an earlier stage makes under this name, or the attribute of the input as
/// float64; nothing if there is none.
std::optional<Attribute> single_value(const char* name, const Schema& input, std::span<const Attribute> made);

}  // namespace pointsweep
