// SPDX-License-Identifier: MIT
/// The names of made attributes in outputs, and the fields that an output has only because of its format.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/attribute.h"
#include "pointsweep/verify/rows/row_source.h"

namespace pointsweep {

/// Returns the schema of records of the values of `made`, in this order, with `prefix` before all names but x, y and z.
Schema schema_of_made(const std::vector<Attribute>& made, const std::string& prefix);

/// Returns whether a field of an output comes from a field of `schema`.
bool is_field_of(const Schema& schema, const std::string& name);

/// The function Format::own_field of a format; null for a format that adds no fields.
using OwnField = std::optional<double> (*)(std::string_view name);

/// Returns the fields among `names` that belong to the format of `out` and hold their default values in all rows.
std::vector<std::string> unfilled_fields(RowSource& out, const std::vector<std::string>& names, OwnField own_field);

}  // namespace pointsweep
