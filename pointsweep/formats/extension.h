// SPDX-License-Identifier: MIT
/// The extension of a file name.
#pragma once

#include <filesystem>
#include <string>

#include "pointsweep/points/lower_case.h"

namespace pointsweep {

/// ".ply" for "scan.PLY", "" if there is none.
inline std::string extension_of(const std::filesystem::path& path) { return in_lower_case(path.extension().string()); }

}  // namespace pointsweep
