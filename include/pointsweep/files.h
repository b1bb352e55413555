// SPDX-License-Identifier: MIT
/// The point files that paths, folders and patterns stand for.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pointsweep/export.h"

namespace pointsweep {

struct ListedFile {
  std::filesystem::path path;
  /// Its name in a folder of outputs: below the folder that was named, below the folders before the first wildcard of a
  /// pattern or below that of a .vpc file; the file name of a file that was named itself.
  std::filesystem::path relative;
};

struct InputList {
  std::vector<ListedFile> files;
  std::vector<std::string> notices;  ///< which files of folders and patterns are left out, a sentence for each argument
};

/// A folder stands for the point files in it, with those of its sub-folders if `recursive`; a pattern that is no file
/// for those that it matches; a .vpc file (virtual point cloud) for those that it names; any other path for itself. The
/// files of a folder or pattern come in the order of the bytes of their relative names. Hidden files are not listed,
/// and files that are no point files are left out with a notice. `format`: as CloudOptions::format; files named *.bin
/// are point files then. Throws Error where an argument stands for no file, UsageError where a file is listed twice and
/// not by its own name both times.
POINTSWEEP_EXPORT InputList list_inputs(const std::vector<std::filesystem::path>& named, bool recursive,
                                        const std::string& format = "");

/// The name of the output in a folder for an input (ListedFile::relative); `format`: an extension, or "" for that of
/// the input. A COPC file is written as LAZ, and programs tell it by its name.
POINTSWEEP_EXPORT std::filesystem::path tile_name(const std::filesystem::path& relative, const std::string& format);

/// Returns whether the path stands for more than itself.
POINTSWEEP_EXPORT bool stands_for_files(const std::filesystem::path& path);

}  // namespace pointsweep
