// SPDX-License-Identifier: MIT
/// In what respects files differ that are meant to be one data set.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "cli/file_row.h"

namespace pointsweep {

/// One sentence for each difference: of formats, coordinate reference systems, clocks of GPS times, attributes that
/// some files lack, and their types; then files without points, with coordinates that are not finite, and with the same
/// bounds and number of points. Empty for fewer than two readable files.
std::vector<std::string> inconsistencies_of(std::span<const FileRow> files);

}  // namespace pointsweep
