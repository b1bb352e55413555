// SPDX-License-Identifier: MIT
/// Names of fields as text headers can hold them.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Returns one name for each component of each field. The components of a field with several become NAME_0, NAME_1,
/// ...; spaces, commas, semicolons, quotes and control characters become '_'; a repeated name gets _2, _3, ... added.
std::vector<std::string> column_names(const Schema& schema);

}  // namespace pointsweep
