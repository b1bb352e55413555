// SPDX-License-Identifier: MIT
/// The number of a point's row in the inputs, as the last field of a record. Conditions and assignments read this
/// number as `row`.
#pragma once

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// The word that stands for the row in conditions and assignments.
inline constexpr const char* kRowWord = "row";
/// The name of the field of the row. It cannot be written in an expression, and differs from the attribute `row` of PTX
/// and E57 files.
inline constexpr const char* kInputRow = "row of the input";

bool has_input_row(const Schema& schema);
/// Returns the schema with the field of the row appended.
Schema with_input_row(Schema schema);
/// Returns the schema without the field of the row. The stride shrinks if the bytes of this field are the last.
Schema without_input_row(Schema schema);

}  // namespace pointsweep
