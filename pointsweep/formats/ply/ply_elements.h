// SPDX-License-Identifier: MIT
/// Walking past the elements of a PLY file that stand before its vertices.
#pragma once

#include <cstdint>

#include "pointsweep/formats/files/input_file.h"
#include "pointsweep/formats/files/line_reader.h"
#include "pointsweep/formats/ply/ply_header.h"

namespace pointsweep {

/// Returns the offset of the first byte after a binary element that starts at `offset`: by arithmetic, or list by list.
/// Throws Error if the file ends inside.
std::uint64_t end_of_binary_element(const InputFile& file, const PlyElement& element, PlyEncoding encoding,
                                    std::uint64_t offset);

/// Moves `lines` past the lines of an ascii element. Throws Error if the file ends inside.
void skip_ascii_element(LineReader& lines, const PlyElement& element);

/// A line that holds anything but spaces.
bool is_ply_row(std::string_view line);

}  // namespace pointsweep
