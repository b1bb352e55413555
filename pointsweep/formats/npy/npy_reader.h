// SPDX-License-Identifier: MIT
/// NumPy arrays of neighbours and distances as rows of values.
#pragma once

#include <filesystem>
#include <memory>

#include "pointsweep/reader.h"

namespace pointsweep {

/// A little-endian, C-ordered array of one or two dimensions (format versions 1 to 3). Its schema has one field for
/// each column: neighbor_0, ... for integers, distance_0, ... for floating numbers. Throws Error for anything else.
std::unique_ptr<Reader> open_npy(const std::filesystem::path& path);

}  // namespace pointsweep
