// SPDX-License-Identifier: MIT
/// Reading points from text, and writing them: .csv with commas, .xyz, .txt, .asc and .pts with spaces.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "pointsweep/formats/format.h"
#include "pointsweep/reader.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// A row for each line, a float64 field for each column (see TextLayout). Opening reads the file once to count the
/// rows. A line with too few or too many cells, or a cell that is no number, is an Error with its line when it is read.
std::unique_ptr<Reader> open_text(const std::filesystem::path& path);

/// Likewise, with these names of the columns, "-" for those that are skipped, whatever they hold. A header is skipped.
std::unique_ptr<Reader> open_text_columns(const std::filesystem::path& path, std::span<const std::string> columns);

/// Returns whether the first lines of the file are such rows, or a header and rows. `columns`: stated names; or empty.
bool fits_text(const std::filesystem::path& path, std::span<const std::string> columns);

/// Every value in the fewest digits that give the same value of its type again. The names of the columns stand in the
/// first line: plain in a .csv, after `# ` otherwise, so that programs that know no header take it for a comment.
/// A .pts starts with the number of points instead, and names its columns only where they are not the usual ones.
std::unique_ptr<Writer> create_text_writer(const OutputPlan& plan);

/// Returns how coordinates are rounded to the digits that are written.
StoredCoordinate text_stored_coordinate(const OutputPlan& plan);

}  // namespace pointsweep
