// SPDX-License-Identifier: MIT
/// The list of formats.
#pragma once

#include <filesystem>
#include <span>

#include "pointsweep/formats/format.h"
#include "pointsweep/program/formats.h"

namespace pointsweep {

/// Returns all formats. A file belongs to the first format with a matching signature.
std::span<const Format* const> formats();

/// Returns the format of an output of this name; null if no format with its extension is written. Standard output gets
/// PLY if it is named "-", and the format of the extension if it is named "-.csv", for example.
const Format* format_of_output(const std::filesystem::path& path);

/// Returns the format in which points are written to a file of this name. Throws UsageError if no format with its
/// extension is written with points, or if `output` is standard output and the format cannot be written there.
const Format& point_format_of_output(const std::filesystem::path& output);

/// Returns the format of arrays, NPY.
const Format& array_format();

}  // namespace pointsweep
