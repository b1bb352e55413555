// SPDX-License-Identifier: MIT
/// Under which names outputs hold what a chain makes.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/attribute.h"

namespace pointsweep {

/// Rows of `made` values as the chain gives them, under the names that the output has for them.
Schema schema_of_made(const std::vector<Attribute>& made, const std::string& prefix);

/// Returns whether a field of an output comes from a field of `schema`.
bool is_field_of(const Schema& schema, const std::string& name);

}  // namespace pointsweep
