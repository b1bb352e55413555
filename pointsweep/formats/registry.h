// SPDX-License-Identifier: MIT
/// The list of formats, and the extension of a file name.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "pointsweep/formats/format.h"
#include "pointsweep/points/lower_case.h"

namespace pointsweep {

/// Returns ".ply" for "scan.PLY", ".copc.laz" for "scan.copc.laz", "" if there is no extension.
std::string extension_of(const std::filesystem::path& path);

/// Returns all formats. A file belongs to the first format with a matching signature.
std::span<const Format* const> formats();

/// Returns the format of an output of this name; null if no format with its extension is written. Standard output is
/// PLY as "-" and text as "-.csv".
const Format* format_of_output(const std::filesystem::path& path);

/// Throws UsageError for standard output in a format that is not sequential.
void require_output_name(const std::filesystem::path& output);

/// Returns whether a file in a folder should be read: if its content has a signature, if it has the extension of a
/// format with a signature, or if it has the extension of any format and is empty. So damaged tiles are not skipped
/// like files of other kinds. A URL is judged only by its extension. Throws Error if the file cannot be read.
bool is_point_file(const std::filesystem::path& path, std::string_view format_name = "");

/// Returns whether a file of this name holds an array, not points.
bool is_array_name(const std::filesystem::path& path);
/// The format of arrays.
const Format& array_format();

/// Returns "PLY, LAS, PCD, QSplat, text": the names of the formats whose files are read as points.
std::string readable_formats();

/// Returns "kitti|float32-xyz": the formats that the user must name (Format::asked_for_as).
std::string formats_asked_for();
/// Throws UsageError where `name` is neither empty nor one of them.
void require_format_asked_for(std::string_view name);

/// Returns "LASzip", or "none (no LAZ)": the codecs of this build, or the formats that it cannot read and write without
/// them.
std::string codecs();

/// The table of docs/formats.md.
std::string formats_table();

}  // namespace pointsweep
