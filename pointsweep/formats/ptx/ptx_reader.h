// SPDX-License-Identifier: MIT
/// Reading PTX files (Leica Geosystems): all scans as one cloud.
#pragma once

#include <filesystem>
#include <memory>

#include "pointsweep/reader.h"

namespace pointsweep {

/// x, y, z as float64 with the transformation of their scan applied; `scan`, `row` and `column` from 0; `intensity` as
/// float64 and red, green, blue as uint8 if any scan has them, 0 in those that lack them. Empty cells are left out; a
/// warning counts them. Opening reads the file once. Throws Error for a damaged or truncated file.
std::unique_ptr<Reader> open_ptx(const std::filesystem::path& path);

}  // namespace pointsweep
