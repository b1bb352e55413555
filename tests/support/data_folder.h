// SPDX-License-Identifier: MIT
/// The folder of the real scans: POINTSWEEP_DATA, or the folder shared/data beside the source tree.
#pragma once

#include <cstdlib>
#include <filesystem>

namespace pointsweep {

/// Returns the folder of the real scans; empty if it does not exist, in which case tests are skipped.
inline std::filesystem::path data_folder() {
  const char* named = std::getenv("POINTSWEEP_DATA");
  const std::filesystem::path folder = named != nullptr && *named != '\0'
                                           ? std::filesystem::path(named)
                                           : std::filesystem::path(POINTSWEEP_SOURCE_DIR) / "../shared/data";
  return std::filesystem::is_directory(folder) ? folder : std::filesystem::path();
}

}  // namespace pointsweep
