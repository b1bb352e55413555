// SPDX-License-Identifier: MIT
/// Files that are nothing but float32 records, without a signature.
#pragma once

#include <filesystem>
#include <memory>

#include "pointsweep/reader.h"

namespace pointsweep {

/// x, y, z and intensity of each point, as the scans of the KITTI data sets. Throws Error if the size is no multiple of
/// 16 bytes.
std::unique_ptr<Reader> open_kitti(const std::filesystem::path& path);

/// x, y, z of each point. Throws Error if the size is no multiple of 12 bytes.
std::unique_ptr<Reader> open_float_xyz(const std::filesystem::path& path);

}  // namespace pointsweep
