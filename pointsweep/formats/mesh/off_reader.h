// SPDX-License-Identifier: MIT
/// Reading the vertices of OFF files (Geomview), in text.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "pointsweep/reader.h"

namespace pointsweep {

/// Whether a file begins with OFF, or with the same behind ST, C and N for texture coordinates, colours and normals.
bool starts_as_off(std::string_view head);

/// Normals of NOFF, colours of COFF, and colours that a plain OFF has behind its coordinates, are read; faces are left
/// out with a warning. Throws Error for a binary file, one of four dimensions, and one that has fewer vertices than its
/// header says.
std::unique_ptr<Reader> open_off(const std::filesystem::path& path);

}  // namespace pointsweep
