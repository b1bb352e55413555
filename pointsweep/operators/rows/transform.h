// SPDX-License-Identifier: MIT
/// The units of the attributes that operators make.
#pragma once

#include <string>

namespace pointsweep {

/// Returns the unit of the attribute `name` that an operator makes as a single value; "1" if no operator makes it.
std::string unit_of_made(const std::string& name);

}  // namespace pointsweep
