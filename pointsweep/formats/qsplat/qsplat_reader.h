// SPDX-License-Identifier: MIT
/// Reading QSplat models (`.qs`, version 11): the leaves of their trees as points.
#pragma once

#include <filesystem>
#include <memory>

#include "pointsweep/reader.h"

namespace pointsweep {

/// Fields x y z nx ny nz radius (f32), and red green blue (u8) if a part of the file has colours. Rows come depth
/// first, the parts of the file one after the other. Opening walks through all trees once, since only that shows how
/// many leaves there are (about 20 ns per leaf), and keeps a place for every 32,768 of them; a jump walks from the
/// place before it. Throws Error for a damaged or truncated file.
std::unique_ptr<Reader> open_qsplat(const std::filesystem::path& path);

}  // namespace pointsweep
