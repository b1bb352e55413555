// SPDX-License-Identifier: MIT
/// Fields that an output has because of its format, and to which neither an input nor a stage gives a value.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/verify/rows/row_source.h"

namespace pointsweep {

/// Format::own_field of a format; null where it has no such fields.
using OwnField = std::optional<double> (*)(std::string_view name);

/// Returns the fields among `names` that belong to the format of `out` and hold its default value in all rows.
std::vector<std::string> unfilled_fields(RowSource& out, const std::vector<std::string>& names, OwnField own_field);

}  // namespace pointsweep
