// SPDX-License-Identifier: MIT
/// Reading the vertices of OFF files (Geomview), in text.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "pointsweep/reader.h"

namespace pointsweep {

/// Returns whether a file begins with OFF, or with ST, C and N (texture coordinates, colours, normals) before OFF.
bool starts_as_off(std::string_view head);

/// Reads normals of NOFF, colours of COFF, and colours that a plain OFF has after its coordinates; leaves faces out
/// with a warning. Throws Error for a binary file, one of four dimensions, and one that has fewer vertices than its
/// header says.
std::unique_ptr<Reader> open_off(const std::filesystem::path& path);

}  // namespace pointsweep
