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

/// Whether an output of this name holds LAS records, compressed or not.
inline bool is_las_name(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  return extension == ".las" || extension == ".laz";
}

}  // namespace pointsweep
