// SPDX-License-Identifier: MIT
/// The meaning of the columns of a text file, from its first lines.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pointsweep/formats/files/input_file.h"
#include "pointsweep/formats/text/text_cells.h"

namespace pointsweep {

struct TextLayout {
  std::vector<std::string> names;          ///< one for each column
  Separator separator = Separator::space;  ///< of the rows; that of the header may differ
  bool has_header = false;
  std::vector<std::string> provenance;     ///< comments before the rows that say how the file was made
  std::optional<std::uint64_t> announced;  ///< rows, as a first line that is nothing but an integer says (PTS)
  std::uint64_t body_offset = 0;           ///< where the rows start
  std::uint64_t body_line = 1;
};

/// Names come from a header: a first line that is not all numbers, or a comment before the rows that names x, y and z
/// and fits their number. Otherwise from the number of columns and what the first rows hold (default_column_names).
/// Throws Error when there are no x, y and z.
TextLayout find_text_layout(const InputFile& file);

}  // namespace pointsweep
