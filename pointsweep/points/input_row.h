// SPDX-License-Identifier: MIT
/// An additional u64 field of records, with the number of the point's row in the inputs, from 0. The conditions of
/// `where` and the assignments of `set` read this number as `row`.
#pragma once

#include "pointsweep/points/schema.h"

namespace pointsweep {

/// The word that stands for the row number in conditions and assignments.
inline constexpr const char* kRowWord = "row";
/// The name of the field. Since the name contains blanks, users cannot write it in an expression, and it differs from
/// the attribute `row` of PTX and E57 files.
inline constexpr const char* kInputRow = "row of the input";

bool has_input_row(const Schema& schema);
/// Returns `schema` with the field of the row number appended, unless `schema` has this field.
Schema with_input_row(Schema schema);
/// Returns `schema` without the field of the row number. The stride shrinks if this field is at the end of the record.
Schema without_input_row(Schema schema);

}  // namespace pointsweep
