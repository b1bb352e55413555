// SPDX-License-Identifier: MIT
/// Reading points from text: .xyz, .txt, .csv, .asc, .pts and the like.
#pragma once

#include <filesystem>
#include <memory>

#include "pointsweep/reader.h"

namespace pointsweep {

/// A row for each line, a float64 field for each column (see TextLayout). Opening reads the file once to count the
/// rows. A line with too few or too many cells, or a cell that is no number, is an Error with its line when it is read.
std::unique_ptr<Reader> open_text(const std::filesystem::path& path);

/// Returns whether the first lines of the file are such rows, or a header and rows.
bool fits_text(const std::filesystem::path& path);

}  // namespace pointsweep
