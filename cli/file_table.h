// SPDX-License-Identifier: MIT
/// Many files side by side, for people.
#pragma once

#include <span>
#include <string>

#include "cli/file_row.h"

namespace pointsweep {

/// A line for each file with points, bounds, density and coordinate reference system, and below them the lists of
/// attributes that the last column counts.
std::string table_of(std::span<const FileRow> files);

/// What all readable files hold together, and in what they differ (inconsistencies.h).
std::string summary_of(std::span<const FileRow> files);

/// Finite points of all files for each unit of their areas together; none without area.
std::optional<double> density_of(std::span<const FileRow> files);

}  // namespace pointsweep
