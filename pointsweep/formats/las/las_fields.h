// SPDX-License-Identifier: MIT
/// Chooses the point format of LAS that holds the attributes of a cloud.
#pragma once

#include <string>
#include <vector>

#include "pointsweep/formats/value_range.h"
#include "pointsweep/points/schema.h"

namespace pointsweep {

/// Names of the fields of `schema` that point formats have, x, y and z left out. Colours count if red, green and blue
/// are there, waveform packets if all of their fields are.
std::vector<std::string> las_names_in(const Schema& schema);

/// True if `target`, a field of a point format, holds every value of `source` in `range`: exactly, but for the scan
/// angle, which is rounded to its steps of 0.006 degrees.
bool las_field_holds(const Field& target, const Field& source, const ValueRange& range);

/// The point format that holds most of las_names_in(schema), and among those the one with the shortest records.
/// `ranges` has one entry for each field of `schema`. Formats 0 to 5 are considered only with `legacy`.
int choose_las_point_format(const Schema& schema, const std::vector<ValueRange>& ranges, bool legacy);

/// Indices of the fields whose types leave open whether the point formats to choose from hold them.
std::vector<std::size_t> undecided_las_fields(const Schema& schema, const std::vector<ValueRange>& ranges, bool legacy);

}  // namespace pointsweep
