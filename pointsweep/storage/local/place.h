// SPDX-License-Identifier: MIT
/// Facts about files and folders that a path or a URL names.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace pointsweep {

/// Returns whether the path names an existing folder. A URL names a folder if it ends in '/'; no server is asked.
bool is_folder(const std::filesystem::path& path);
/// Returns whether a file, folder or object of this name exists.
bool exists_at(const std::filesystem::path& path);
/// Returns the size in bytes of a regular file or of an object; nothing if there is no file or object of this name.
std::optional<std::uint64_t> bytes_of_file(const std::filesystem::path& path);
/// Returns the absolute path without `.` and `..`; returns a URL unchanged.
std::string whole_name(const std::filesystem::path& path);
/// Returns the name of the file without its folders, and without the query of a URL.
std::filesystem::path file_name(const std::filesystem::path& path);
/// Returns whether both files are in the same folder.
bool share_folder(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace pointsweep
