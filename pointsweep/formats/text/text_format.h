// SPDX-License-Identifier: MIT
/// Points as text: lines as cells, the meaning of the columns from the first lines of a file, a reader, and a writer of
/// .csv with commas, .xyz, .txt, .asc and .pts with spaces.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/formats/format.h"
#include "pointsweep/reader.h"
#include "pointsweep/storage/local/input_file.h"
#include "pointsweep/writer.h"

namespace pointsweep {

/// The separator of the cells of a line: a semicolon, if one occurs outside of quotes, else a vertical bar, else a
/// comma; spaces and tabs if none of these occurs.
enum class Separator : char { space = ' ', comma = ',', semicolon = ';', bar = '|' };

Separator separator_of(std::string_view line);

/// Splits a line into cells without surrounding spaces and quotes. With separators other than blanks, cells may be
/// empty; an empty cell after the last separator is dropped.
void split_cells(std::string_view line, Separator separator, std::vector<std::string_view>& cells);

/// Returns whether a line has cells: it is neither blank nor a comment, which begins with `#`, `%` or `//`.
bool is_text_row(std::string_view line);
/// Returns whether a line is a row of points in files in which other lines state a number of rows (PTS): a row has more
/// than one cell.
bool is_pts_row(std::string_view line);
/// Returns the text after the `#`, `%` or `//` of a comment; empty for other lines.
std::string_view comment_of(std::string_view line);

/// Parses the number in a cell; an empty cell, "na", "n/a" and "null" are NaN. Returns false if the cell is not a
/// number.
bool parse_cell(std::string_view cell, double& value);

/// Returns whether the cell is a whole number in the range of int64 or uint64 that float64 does not hold.
bool needs_integer(std::string_view cell);

/// The name, in --columns, of a column that is skipped.
inline constexpr std::string_view kSkippedColumn = "-";

/// Returns whether one of the cells that `columns` names is a number.
bool has_number(std::span<const std::string_view> cells, std::span<const std::string> columns);

struct TextLayout {
  std::vector<std::string> names;           ///< one for each column; kSkippedColumn for a skipped column
  std::vector<Type> types;                  ///< one for each column
  bool are_stated = false;                  ///< true if `names` come from --columns
  std::vector<std::string> replaced_names;  ///< names in the file's header that stated names replace
  Separator separator = Separator::space;   ///< separator of the rows; the header may have another one
  bool has_header = false;
  std::vector<std::string> provenance;     ///< comment lines before the rows with the record of the run
  std::optional<std::uint64_t> announced;  ///< number of rows that a first line with only an integer states (PTS)
  std::uint64_t body_offset = 0;           ///< byte at which the rows start
  std::uint64_t body_line = 1;
};

/// Finds the layout. A column is float64, unless its first rows are whole numbers some of which float64 does not hold:
/// then it is int64, or uint64 if a number is above the range of int64. x, y and z always are float64. Names come from
/// a header: a first line that is not all numbers, or a comment before the rows that names x, y and z and has a name
/// for each column. Otherwise they follow from the number of columns and the first rows (default_column_names). Throws
/// Error if there are no x, y and z. `stated`: names that replace all others; a first line without a number in a named
/// column is then a header.
TextLayout find_text_layout(const InputFile& file, std::span<const std::string> stated = {});

/// Opens a text file with a row for each line and a field for each column (see TextLayout). Opening reads the file once
/// to count the rows. A line with too few or too many cells, a cell that is not a number, or a whole number of 64 bits
/// that its column does not hold exactly causes an Error that names the line when the line is read.
std::unique_ptr<Reader> open_text(const std::filesystem::path& path);

/// Opens a text file whose columns have the given names. The content of a column with the name "-" is ignored. A header
/// is skipped.
std::unique_ptr<Reader> open_text_columns(const std::filesystem::path& path, std::span<const std::string> columns);

/// Returns whether the first lines of the file are rows of points, or a header and such rows. `columns`: the names of
/// columns that the user states; may be empty, and then a header alone is enough.
bool fits_text(const std::filesystem::path& path, std::span<const std::string> columns);

/// Creates a writer that writes each value with the fewest digits that represent it in its type, scaled integers as the
/// decimal numbers that GridDecimals restores, and coordinates with FileLayout::decimals digits after the point if the
/// plan states them. The first line has the names of the columns: plain in a .csv, otherwise after `# `, which programs
/// without support for headers take as a comment. A .pts starts with the number of points instead, and states column
/// names only if they are not the usual ones. Provenance follows as comments, except in a .csv.
std::unique_ptr<Writer> create_text_writer(const OutputPlan& plan);

/// Returns how coordinates are rounded to the digits that are written; none if they are written exactly.
StoredCoordinate text_stored_coordinate(const OutputPlan& plan);

}  // namespace pointsweep
