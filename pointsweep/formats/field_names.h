// SPDX-License-Identifier: MIT
/// Names of fields as text headers can hold them.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// One name for each component of each field: a field of several becomes NAME_0, NAME_1, ...; spaces, commas,
/// semicolons, quotes and control characters become '_'; a name that was given already gets _2, _3, ... behind it.
std::vector<std::string> column_names(const Schema& schema);

}  // namespace pointsweep
