// SPDX-License-Identifier: MIT
/// Standard input as an input file and standard output as an output file. Both are called "-".
#pragma once

#include <filesystem>

#include "pointsweep/export.h"

namespace pointsweep {

/// Returns whether a path means standard input (as an input) or standard output (as an output): "-". A file of that
/// name is "./-".
POINTSWEEP_EXPORT bool is_standard_stream(const std::filesystem::path& path);

/// Returns whether the path of an output means standard output: "-", or "-" and the extension of a format, "-.csv".
POINTSWEEP_EXPORT bool is_standard_output(const std::filesystem::path& path);

/// Makes standard input readable at any offset as the file "-": a pipe is copied to a file without a name in `folder`
/// (empty: the system's temporary folder), with 1 MB of memory. Must be called before the file is opened; later calls
/// are no-ops. Throws Error if standard input is a terminal, or the folder has no space for it.
POINTSWEEP_EXPORT void take_standard_input(const std::filesystem::path& folder);

}  // namespace pointsweep
