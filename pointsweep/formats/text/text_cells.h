// SPDX-License-Identifier: MIT
/// Lines of text files as cells.
#pragma once

#include <string_view>
#include <vector>

namespace pointsweep {

/// The separator of the cells of a line: a semicolon, vertical bar or comma, the first of them that there is outside
/// quotes; spaces and tabs otherwise.
enum class Separator : char { space = ' ', comma = ',', semicolon = ';', bar = '|' };

Separator separator_of(std::string_view line);

/// Cells without surrounding spaces and quotes. Where a character other than a blank separates, cells may be empty; an
/// empty cell after a last separator is left out.
void split_cells(std::string_view line, Separator separator, std::vector<std::string_view>& cells);

/// True for lines that hold cells: neither blank nor a comment, which `#`, `%` or `//` starts.
bool is_text_row(std::string_view line);
/// True for rows of files that state numbers of rows on lines of their own (PTS): lines of more than one cell.
bool is_pts_row(std::string_view line);
/// Returns the text after the `#`, `%` or `//` of a comment; empty for other lines.
std::string_view comment_of(std::string_view line);

/// The number in a cell; an empty cell, "na", "n/a" and "null" are NaN. False if it is none.
bool parse_cell(std::string_view cell, double& value);

}  // namespace pointsweep
