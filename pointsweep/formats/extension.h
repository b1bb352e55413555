// SPDX-License-Identifier: MIT
/// What a file calls itself.
#pragma once

#include <filesystem>
#include <string>

namespace pointsweep {

/// ".ply" for "scan.PLY", "" if there is none.
inline std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return extension;
}

}  // namespace pointsweep
