// SPDX-License-Identifier: MIT
/// Reading PLY files, ascii and binary of either byte order.
#pragma once

#include <filesystem>
#include <memory>

#include "pointsweep/reader.h"

namespace pointsweep {

/// The points are the entries of the element `vertex`, with all of their properties. Other elements are walked past and
/// named in FileInfo::warnings, since an output does not keep them. Records of a binary file are its bytes (of a
/// big-endian one turned around). Throws Error for lists on vertices, missing x, y or z, and fewer vertices than the
/// header says.
std::unique_ptr<Reader> open_ply(const std::filesystem::path& path);

}  // namespace pointsweep
