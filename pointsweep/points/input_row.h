// SPDX-License-Identifier: MIT
/// The number of a point's row in the inputs, as the last field of a record: conditions and assignments read it as
/// `row`.
#pragma once

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// The word for the row in conditions and assignments.
inline constexpr const char* kRowWord = "row";
/// The name of the field, which is not a word of the expressions and differs from the attribute `row` of PTX and E57.
inline constexpr const char* kInputRow = "row of the input";

bool has_input_row(const Schema& schema);
/// Returns the schema with the field at the end of its record.
Schema with_input_row(Schema schema);
/// Returns the schema without the field, and its stride without the bytes of the field if they are the last.
Schema without_input_row(Schema schema);

}  // namespace pointsweep
