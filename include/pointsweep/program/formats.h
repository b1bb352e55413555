// SPDX-License-Identifier: MIT
/// The formats that this build reads and writes, and the formats that names of files mean. For programs that take names
/// of files from people.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pointsweep/export.h"

namespace pointsweep {

/// Returns ".ply" for "scan.PLY", ".copc.laz" for "scan.copc.laz", "" if there is no extension.
POINTSWEEP_EXPORT std::string extension_of(const std::filesystem::path& path);

/// Returns whether an output has the extension of a format for points or arrays that the library writes, even if this
/// build lacks the codec. The name "-" is PLY to standard output, "-.csv" is text to standard output.
POINTSWEEP_EXPORT bool has_output_format(const std::filesystem::path& output);
/// Returns whether this build writes point files of this name.
POINTSWEEP_EXPORT bool writes_points_to(const std::filesystem::path& output);
/// Returns whether a file of this name holds an array, not points.
POINTSWEEP_EXPORT bool is_array_name(const std::filesystem::path& path);
/// Throws UsageError for standard output in a format whose bytes are not written in order.
POINTSWEEP_EXPORT void require_output_name(const std::filesystem::path& output);

/// Returns whether a file in a folder should be read, which must be a regular file: if its content has a signature or
/// fits a format without one (text), if it has the extension of a format with a signature, if it has the extension of
/// any format and is empty, or if `format` names a format of .bin files and it is one. So damaged tiles are not skipped
/// like files of other kinds. A URL is judged only by its extension. `format`: as for open_reader(). Throws Error if
/// the file cannot be read.
POINTSWEEP_EXPORT bool is_point_file(const std::filesystem::path& path, std::string_view format = "");
/// Returns whether a folder has a point file that is not hidden; sub-folders do not count.
POINTSWEEP_EXPORT bool holds_point_files(const std::filesystem::path& folder);

/// Returns a text like "PLY, LAS, PCD, QSplat, text": the names of the formats whose files are read as points.
POINTSWEEP_EXPORT std::string readable_formats();
/// Returns the extensions that create_writer() knows, e.g. ".ply".
POINTSWEEP_EXPORT std::vector<std::string_view> writable_extensions();
/// Returns ".npy", the extension of arrays.
POINTSWEEP_EXPORT std::string_view array_extension();
/// Returns "kitti|float32-xyz": the formats that the user must name, since neither a file nor its name tells them.
POINTSWEEP_EXPORT std::string formats_asked_for();
/// Throws UsageError if `name` is no value for the parameter `format` of open_reader().
POINTSWEEP_EXPORT void require_format_asked_for(std::string_view name);
/// Returns the codecs of this build and, in parentheses, the formats that it lacks: "LASzip" or "none (no LAZ)".
POINTSWEEP_EXPORT std::string codecs();
/// Returns the table of docs/formats.md.
POINTSWEEP_EXPORT std::string formats_table();

}  // namespace pointsweep
