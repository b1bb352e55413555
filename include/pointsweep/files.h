// SPDX-License-Identifier: MIT
/// Lists of the point files for which paths, folders and patterns stand.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pointsweep/export.h"

namespace pointsweep {

struct ListedFile {
  std::filesystem::path path;
  /// The path of the file in a folder of outputs: its path below the named folder, below the folders before the first
  /// wildcard of a pattern, or below the folder of the .vpc file; its name if it lies elsewhere or was named itself.
  std::filesystem::path relative;
};

struct InputList {
  std::vector<ListedFile> files;
  std::vector<std::string> notices;  ///< a sentence for each argument that stands for files that are not listed
};

/// Lists the files that arguments stand for: a folder for the point files in it, if `recursive` also in its
/// sub-folders; a pattern that is no file for its matches; a .vpc file (virtual point cloud) for the files that it
/// names; any other path for itself. The files of a folder or pattern come in the order of the bytes of their relative
/// names. Hidden files are not listed, and files that are no point files are left out with a notice. `format`: as
/// CloudOptions::format; files named *.bin are point files then. Throws Error if an argument stands for no file,
/// UsageError if a file is listed twice, unless both arguments name the file itself.
POINTSWEEP_EXPORT InputList list_inputs(const std::vector<std::filesystem::path>& named, bool recursive,
                                        const std::string& format = "");

/// Returns the path, below a folder of outputs, of the output for an input with the path `relative`
/// (ListedFile::relative). `format`: an extension, which replaces the whole extension of the input (".copc.laz" of a
/// COPC file), or "" to keep the extension of the input.
POINTSWEEP_EXPORT std::filesystem::path tile_name(const std::filesystem::path& relative, const std::string& format);

/// Throws UsageError if a file of `written` is one of `read` or is written twice: the same device and inode (symbolic
/// links, hard links, /proc/self/fd), or the same canonical path (also of files that do not exist yet). Empty paths are
/// ignored.
POINTSWEEP_EXPORT void require_separate_files(const std::vector<std::filesystem::path>& read,
                                              const std::vector<std::filesystem::path>& written);

/// Returns whether the path stands for other files: a folder, a pattern or a .vpc file.
POINTSWEEP_EXPORT bool stands_for_files(const std::filesystem::path& path);

}  // namespace pointsweep
