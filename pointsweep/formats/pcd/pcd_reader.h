// SPDX-License-Identifier: MIT
/// Reading PCD files (Point Cloud Library): ascii, binary and binary_compressed.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "pointsweep/reader.h"

namespace pointsweep {

/// Returns whether a file that begins with `head` is a PCD file.
bool starts_as_pcd(std::string_view head);

/// All fields with their counts; a colour packed into `rgb` or `rgba` becomes red, green, blue (and alpha). Points
/// whose coordinates are NaN, as organised clouds have where the sensor saw nothing, are points. VIEWPOINT is not
/// applied; if it moves or turns the points a warning says so, another that the rows and columns of an organised cloud
/// are not kept. A decoder decompresses the wanted fields side by side, in about 70 KB for each field; the reader keeps
/// 8 KB of each field for every 16 MB of the widest. Opening a compressed file decompresses it once. Throws Error for a
/// damaged or truncated file.
std::unique_ptr<Reader> open_pcd(const std::filesystem::path& path);

}  // namespace pointsweep
