// SPDX-License-Identifier: MIT
/// Attributes of one value that an operator reads by name, from earlier stages or the input.
#pragma once

#include <optional>
#include <span>

#include "pointsweep/operator.h"

namespace pointsweep {

/// Returns the attribute `name` if an earlier stage makes it and it has one value, else the field `name` of the input
/// as float64; nullopt if there is none.
std::optional<Attribute> single_value(const char* name, const Schema& input, std::span<const Attribute> made);

}  // namespace pointsweep
