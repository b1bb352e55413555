// SPDX-License-Identifier: MIT
/// A reader and a writer of points as text: .csv with commas, .xyz, .txt, .asc and .pts with spaces.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "pointsweep/formats/format.h"
#include "pointsweep/reader.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// Opens a text file with a row for each line and a float64 field for each column (see TextLayout). Opening reads the
/// file once to count the rows. A line with too few or too many cells, or a cell that is not a number, causes an Error
/// that names the line when the line is read.
std::unique_ptr<Reader> open_text(const std::filesystem::path& path);

/// Opens a text file whose columns have the given names. The content of a column with the name "-" is ignored. A header
/// is skipped.
std::unique_ptr<Reader> open_text_columns(const std::filesystem::path& path, std::span<const std::string> columns);

/// Returns whether the first lines of the file are rows of points, or a header and such rows. `columns`: the names of
/// columns that the user states; may be empty.
bool fits_text(const std::filesystem::path& path, std::span<const std::string> columns);

/// Creates a writer that writes each value with the fewest digits that represent it in its type, and coordinates with
/// FileLayout::decimals digits if the plan states them. The first line has the names of the columns: plain in a .csv,
/// otherwise after `# `, which programs without support for headers take as a comment. A .pts starts with the number of
/// points instead, and states column names only if they are not the usual ones.
std::unique_ptr<Writer> create_text_writer(const OutputPlan& plan);

/// Returns how coordinates are rounded to the digits that are written; none if they are written exactly.
StoredCoordinate text_stored_coordinate(const OutputPlan& plan);

}  // namespace pointsweep
